"""Which object stands on which: network and training."""

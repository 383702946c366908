"""Which kind of scene it is: network and training."""

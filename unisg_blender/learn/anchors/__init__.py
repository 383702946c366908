"""The anchor mixture with its critic: network, examples, training."""

"""The network of behaviour: network, examples, training."""

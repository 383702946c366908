"""AtlasNet: network, training, export."""

"""The paper's conditional graph VAE: network and training."""

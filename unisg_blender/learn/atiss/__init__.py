"""A set model in the style of ATISS, a baseline: network and training."""

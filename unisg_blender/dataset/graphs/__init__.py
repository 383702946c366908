"""Scenes of a dataset as heterogeneous graphs."""

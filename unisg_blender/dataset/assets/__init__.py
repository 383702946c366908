"""The geometry that goes with a dataset: assets, and scenes with their true shapes."""

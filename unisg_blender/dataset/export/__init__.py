"""Folders of scene files become a dataset: in parallel, under limits, resumable."""

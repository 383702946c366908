"""The last check of what was placed, by meshes; it knows nothing of how places are found."""

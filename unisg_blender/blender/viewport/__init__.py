"""What is shown and played in the 3D viewport."""

"""What a model sees of a scene, and what training scenes say about categories."""

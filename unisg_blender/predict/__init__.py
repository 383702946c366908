"""What a trained network says about a scene: which object stands on which, and what kind of scene it is. No torch."""

"""What a scene is in space: objects, structure, supports, surfaces, the floor plan, relations."""

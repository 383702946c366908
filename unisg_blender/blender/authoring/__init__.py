"""Categories, identities, actions and lessons written onto Blender objects."""

"""From the scenegraph to Blender objects."""

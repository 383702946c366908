"""From Blender to the scenegraph; reading never writes."""

"""From a USD stage to the scenegraph."""

"""From the scenegraph to the specs of a USD layer."""

"""What a scenegraph cannot hold of a Blender scene, told object by object."""

"""Keyframes, animation and recordings in Blender's scenes."""

"""Exactness and speed of the pose forms, and of keyframe reduction."""

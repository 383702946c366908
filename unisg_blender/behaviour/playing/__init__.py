"""Lessons in time: whether one can be played, the player, its events, the timeline."""

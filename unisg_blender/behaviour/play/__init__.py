"""Lessons in time: state, conditions, player, rehearsal, timeline."""

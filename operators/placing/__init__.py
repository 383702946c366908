"""Placing one thing after another by pointing into the viewport."""

"""Lessons as data: the tree, its edits, where each action stands, how far the tree has come."""

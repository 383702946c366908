"""Lessons as data: the tree, its edits, and whether it is sound."""

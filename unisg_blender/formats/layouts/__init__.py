"""Rooms that other programs keep as JSON: a module for each kind, recognised by what the file holds."""

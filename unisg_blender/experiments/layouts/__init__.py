"""What stands on what in rooms that others designed."""

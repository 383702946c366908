"""The generator's table: rooms furnished and completed by models and by simple rules."""

"""The model of category proposals."""

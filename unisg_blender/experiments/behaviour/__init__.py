"""How well new objects get their behaviour."""

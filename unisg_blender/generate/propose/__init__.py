"""Where new objects could be: proposals of trained models, and requests of users."""

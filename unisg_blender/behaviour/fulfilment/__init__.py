"""Is an action done? Actions of one type at once, at one moment of the scene."""

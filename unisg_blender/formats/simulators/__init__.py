"""Worlds and robots of simulators, which are XML: a module for each kind, recognised by its root element."""

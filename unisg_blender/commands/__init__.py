"""The verbs of the command line, one module each; see :mod:`unisg_blender.cli`."""

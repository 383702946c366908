"""UniSG for Blender: scenegraphs that join geometry, behaviour and graph learning.

Importing this package loads neither Blender (``bpy``) nor ``torch``: each room
imports what it needs when it is opened.
"""

from __future__ import annotations

from .errors import UniSGError

__version__ = "0.1.0"
__all__ = ["UniSGError", "__version__"]

"""Between Blender and the scenegraph: the only room that imports ``bpy``.

Importing it where Blender is missing raises a
:class:`~unisg_blender.errors.MissingPackageError` with the install line.
"""

from __future__ import annotations

from ..errors import MissingPackageError

try:
    import bpy as _bpy  # noqa: F401
except ImportError:
    raise MissingPackageError("bpy", "blender") from None

from .lookup import objects_by_uid
from .read import read_scene, read_scenes
from .report import ReadReport
from .write import write_rows, write_scene

__all__ = ["ReadReport", "objects_by_uid", "read_scene", "read_scenes", "write_rows", "write_scene"]

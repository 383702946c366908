"""Between Blender and the scenegraph: the only room that imports ``bpy``.

Importing it where Blender is missing raises a
:class:`~unisg_blender.errors.MissingPackageError` with the install line.
"""

from __future__ import annotations

from ..errors import MissingPackageError
from ..runtime.output_capture import captured_output
from ..runtime.process_end import signals_kept

try:
    with captured_output(), signals_kept():  # the bpy package says on stdout what it found while it starts
        import bpy as _bpy  # noqa: F401
except ImportError:
    raise MissingPackageError("bpy", "blender") from None

from ..runtime.read_report import ReadReport
from .blend_files import SUFFIXES, new_file, open_file, read_file, save_blend
from .lookup import objects_by_uid
from .read.sampled_animation import sample_animation
from .read.scene_reader import read_scene, read_scenes
from .render.picture import render_picture
from .render.room_view import RoomView
from .write.scene_writer import write_rows, write_scene

__all__ = [
    "SUFFIXES", "ReadReport", "RoomView", "new_file", "objects_by_uid", "open_file", "read_file", "read_scene",
    "read_scenes", "render_picture", "sample_animation", "save_blend", "write_rows", "write_scene",
]  # fmt: skip

"""A file of geometry alone as a scene: an entity for each place in which it shows a mesh."""

from __future__ import annotations

from pathlib import Path

from ..runtime.read_report import ReadReport
from ..scene import SceneGraph
from .mesh_parts import PLAIN, mesh_parts
from .room_builder import RoomBuilder


def mesh_scene(path: Path) -> tuple[SceneGraph, ReadReport]:
    """The scene of a file of one of :data:`~..runtime.file_endings.MESHES`, and what it could not hold.

    Raises
    ------
    UniSGError
        If it cannot be read, or has no geometry.
    """
    report = ReadReport()
    builder = RoomBuilder(path.stem)
    for name, matrix, mesh in mesh_parts(path):
        builder.add("", matrix, mesh, name=name or mesh.name or path.stem)
    report.add("", "materials, textures and motion are not read")
    if path.suffix.lower() in PLAIN:
        report.add("", f"a {path.suffix.lower()} has no unit and no axis that is up: it is taken in metres, z up")
    return builder.build(), report

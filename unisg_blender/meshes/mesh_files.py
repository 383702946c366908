"""Mesh files (.obj .glb .gltf .ply .stl .off) as meshes, without Blender."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ..errors import UniSGError
from ..scene.mesh import Mesh, mesh_from_faces

MESH_SUFFIXES = (".obj", ".glb", ".gltf", ".ply", ".stl", ".off")
Y_UP_SUFFIXES = (".obj", ".glb", ".gltf")
Y_UP_TO_Z_UP = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
"""(x, y, z) with y up becomes (x, -z, y) with z up."""


def read_mesh_file(path: str | Path) -> Mesh:
    """All geometry of one file as a single triangle mesh, Z up, in the file's unit.

    .obj, .gltf and .glb are taken as Y up, the others as Z up. A file that holds
    points and no faces becomes a mesh without faces.

    Raises
    ------
    UniSGError
        If the file is missing, of an unknown kind, damaged or without geometry.
    """
    import trimesh

    path = Path(path)
    if path.suffix.lower() not in MESH_SUFFIXES:
        raise UniSGError(f"{path}: not a mesh file; use one of {' '.join(MESH_SUFFIXES)}")
    if not path.is_file():
        raise UniSGError(f"{path}: no such file")
    try:
        loaded = trimesh.load(path, process=False, skip_materials=True)
        parts = _parts(loaded) if isinstance(loaded, trimesh.Scene) else [loaded]
    except Exception as error:  # readers of foreign formats fail in a hundred ways
        raise UniSGError(f"{path}: cannot be read as a mesh: {error}") from error
    return _joined(path, [part for part in parts if hasattr(part, "vertices") and len(part.vertices)])


def mesh_paths(folder: str | Path) -> list[Path]:
    """The mesh files under a folder, sorted; UniSGError if it does not exist or has none."""
    folder = Path(folder)
    if not folder.is_dir():
        raise UniSGError(f"{folder}: no such folder")
    paths = sorted(path for path in folder.rglob("*") if path.suffix.lower() in MESH_SUFFIXES)
    if not paths:
        raise UniSGError(f"{folder}: no mesh files here; looked for {' '.join(MESH_SUFFIXES)}")
    return paths


def _parts(scene: Any) -> list:
    """A scene's geometry where it stands, without the pictures: copying those wants Pillow, which Blender lacks."""
    from trimesh.visual import ColorVisuals

    for part in scene.geometry.values():
        if hasattr(part, "visual"):
            part.visual = ColorVisuals()
    return scene.dump()


def _joined(path: Path, parts: list) -> Mesh:
    if not parts:
        raise UniSGError(f"{path}: holds no geometry")
    starts = np.cumsum([0] + [len(part.vertices) for part in parts])
    points = np.concatenate([np.asarray(part.vertices, np.float64) for part in parts])
    empty = np.zeros((0, 3), np.int64)
    triangles = [
        np.asarray(getattr(part, "faces", empty), np.int64) + start for part, start in zip(parts, starts, strict=False)
    ]
    if path.suffix.lower() in Y_UP_SUFFIXES:
        points = points @ Y_UP_TO_Z_UP.T
    faces = np.concatenate(triangles)
    mesh = mesh_from_faces(path.stem, points, np.zeros((0, 3), np.int64))
    return Mesh(mesh.name, mesh.points, faces.astype(np.int32).ravel(), np.arange(len(faces) + 1, dtype=np.int32) * 3)

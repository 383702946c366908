"""The meshes of a file, read without Blender: each mesh once, and where the file puts it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import UniSGError
from ..runtime.atomic_files import check_plain
from ..runtime.guarded_work import reading_part
from ..runtime.large_file_pointer import refuse_pointer
from ..scene import Mesh, mesh_from_faces
from .axes import Y_UP, Array, pose
from .collada import Part, collada_parts
from .plain_xml import parse_xml

PLAIN = (".ply", ".stl", ".off")
"""Kinds without a unit and an axis that is up: they are taken in metres, with z up."""

Y_UP_KINDS = (".glb", ".gltf", ".obj")
KINDS = (".dae", *PLAIN, ".3mf", *Y_UP_KINDS)


@lru_cache(maxsize=512)
def mesh_parts(path: Path, upright: bool = True) -> tuple[Part, ...]:
    """Names, matrices to our frame in metres, and meshes of a file.

    Parameters
    ----------
    path
        A file of one of :data:`KINDS`.
    upright
        Whether the file's up axis becomes z. Without, the frame is the file's own.

    Raises
    ------
    UniSGError
        If it cannot be read, or has no geometry.
    """
    refuse_pointer(path)
    reading_part(path)
    try:
        check_plain(path)
        if path.suffix.lower() == ".dae":
            found = collada_parts(parse_xml(path.read_bytes(), path), path, upright)
        elif path.suffix.lower() == ".3mf":
            from .threemf import threemf_parts

            found = threemf_parts(path)
        else:
            found = _by_trimesh(path, upright)
    except OSError as error:
        raise UniSGError(f"cannot read {path}: {error.strerror or error}") from None
    except UniSGError:
        raise
    except Exception as error:  # what trimesh raises over a damaged file is not told
        raise UniSGError(f"cannot read {path}: {type(error).__name__}: {error}".splitlines()[0]) from None
    if not found:
        raise UniSGError(f"cannot read {path}: it has no geometry")
    return tuple(found)


def _by_trimesh(path: Path, upright: bool) -> list[Part]:
    import trimesh

    turned = upright and path.suffix.lower() in Y_UP_KINDS
    change = Y_UP if turned else np.eye(4)
    options: dict[str, Any] = {"skip_materials": True} if path.suffix.lower() in Y_UP_KINDS else {}
    loaded = trimesh.load_scene(path, process=False, **options)
    meshes = {key: _mesh(key, part, change) for key, part in loaded.geometry.items() if hasattr(part, "vertices")}
    parts = [(str(node), *loaded.graph[node]) for node in loaded.graph.nodes_geometry]
    return [(name, change @ matrix @ change.T, meshes[key]) for name, matrix, key in parts if key in meshes]


def _mesh(name: str, part: Any, change: Array) -> Mesh:
    points = np.asarray(part.vertices, np.float64) @ change[:3, :3].T
    faces = np.asarray(getattr(part, "faces", np.zeros((0, 3))), np.int64).reshape(-1, 3)
    points, same = np.unique(points, axis=0, return_inverse=True)  # corners of a .stl are told for each face
    return mesh_from_faces(name, points, same.reshape(-1)[faces] if len(faces) else faces)


@lru_cache(maxsize=2048)
def whole_mesh(path: Path, upright: bool = True) -> Mesh:
    """All that a file shows as one mesh in our frame."""
    return joined_mesh(path.stem, [(matrix, mesh) for _, matrix, mesh in mesh_parts(path, upright)])


def joined_mesh(name: str, parts: Sequence[tuple[Array, Mesh]]) -> Mesh:
    """Meshes, each moved by a matrix (4, 4), as one; colours, normals and seams are left out."""
    placed = [moved(mesh, matrix) for matrix, mesh in parts]
    starts = np.cumsum([0, *(len(mesh.points) for mesh in placed)])
    ends = np.cumsum([0, *(len(mesh.corners) for mesh in placed)])
    corners = [mesh.corners + start for mesh, start in zip(placed, starts[:-1], strict=True)]
    offsets = [mesh.offsets[:-1] + end for mesh, end in zip(placed, ends[:-1], strict=True)]
    return Mesh(
        name,
        np.concatenate([np.zeros((0, 3), np.float32), *(mesh.points for mesh in placed)]),
        np.concatenate([np.zeros(0), *corners]).astype(np.int32),
        np.concatenate([*offsets, ends[-1:]]).astype(np.int32),
    )


def fitted(mesh: Mesh, size: Array) -> Mesh:
    """A mesh stretched to a size (3,), so that it stands on the origin of its frame."""
    low, high = mesh.bounds
    foot = np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]])
    stretch = np.diag([*(size / np.maximum(high - low, 1e-6)), 1.0])
    return moved(mesh, stretch @ pose(-foot))


def moved(mesh: Mesh, matrix: Array) -> Mesh:
    """A mesh with its points moved by a matrix; faces of a mirrored one are turned around."""
    points = (mesh.points @ matrix[:3, :3].T + matrix[:3, 3]).astype(np.float32)
    if np.linalg.det(matrix[:3, :3]) >= 0:
        return replace(mesh, points=points)
    sizes = np.diff(mesh.offsets)
    first = np.repeat(mesh.offsets[:-1], sizes)
    turned = 2 * first + np.repeat(sizes, sizes) - 1 - np.arange(len(mesh.corners))
    return replace(mesh, points=points, corners=mesh.corners[turned], normals=None, uvs={})

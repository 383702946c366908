"""The shapes that simulators have, as meshes around the origin, z up; lengths in metres."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ...scene import Mesh, box_mesh, mesh_from_faces
from ..axes import Array, numbers

AROUND = 24
"""Corners of a circle."""

Points = list[list[float]]


@lru_cache(maxsize=4096)
def shape(kind: str, *size: float) -> Mesh:
    """A mesh: "box" x, y, z; "sphere" radius; "ellipsoid" three radii; "cylinder" and "capsule" radius, length (of the
    straight part); "plane" x, y. ValueError if a number is not positive, or the kind unknown.
    """
    if not all(np.isfinite(size)) or min(size) <= 0 or len(size) != COUNTS.get(kind, -1):
        raise ValueError(f"no {kind} has the size {size}")
    if kind == "box":
        return box_mesh(kind, size, -0.5)
    if kind == "plane":
        x, y = size[0] / 2, size[1] / 2
        return mesh_from_faces(kind, np.array([[-x, -y, 0], [x, -y, 0], [x, y, 0], [-x, y, 0]]), [[0, 1, 2, 3]])
    if kind == "cylinder":
        half = size[1] / 2
        return _turned(kind, [(size[0], -half), (size[0], half)], -half, half, flat=True)
    radii = np.array(size if kind == "ellipsoid" else (size[0],) * 3)
    middle = size[1] / 2 if kind == "capsule" else 0.0
    angles = np.linspace(-np.pi / 2, np.pi / 2, AROUND // 2 + 1)[1:-1]
    rings = [(np.cos(angle), np.sin(angle)) for angle in angles]
    mesh = _turned(kind, rings, -1.0, 1.0)
    points = mesh.points * radii
    if middle:
        points = points + np.sign(np.round(points[:, 2:], 9)) * (0, 0, middle)
    return Mesh(kind, points.astype(np.float32), mesh.corners, mesh.offsets)


COUNTS = {"box": 3, "plane": 2, "cylinder": 2, "capsule": 2, "sphere": 1, "ellipsoid": 3}


def _turned(name: str, rings: list[tuple[float, float]], low: float, high: float, flat: bool = False) -> Mesh:
    """Circles (radius, height) around z, closed by faces or by points at ``low`` and ``high``."""
    turns = np.linspace(0, 2 * np.pi, AROUND, endpoint=False)
    circle = np.column_stack([np.cos(turns), np.sin(turns), np.zeros(AROUND)])
    points = [circle * (radius, radius, 0) + (0, 0, height) for radius, height in rings]
    steps = np.arange(AROUND)
    after = (steps + 1) % AROUND
    sides = [
        [*row] for ring in range(len(rings) - 1)
        for row in (np.stack([steps, after, AROUND + after, AROUND + steps], 1) + ring * AROUND).tolist()
    ]  # fmt: skip
    top = (len(rings) - 1) * AROUND
    if flat:
        return mesh_from_faces(name, np.concatenate(points), [*sides, steps[::-1].tolist(), (top + steps).tolist()])
    count = len(rings) * AROUND
    ends = [[count, int(b), int(a)] for a, b in zip(steps, after, strict=True)]
    ends += [[count + 1, int(top + a), int(top + b)] for a, b in zip(steps, after, strict=True)]
    return mesh_from_faces(name, np.concatenate([*points, [[0, 0, low], [0, 0, high]]]), [*sides, *ends])


def text_numbers(text: str | None, count: int, default: Array | None = None) -> Array:
    """``count`` numbers of an attribute; ``default`` where there are none."""
    if not (text or "").strip() and default is not None:
        return default
    return numbers((text or "").split(), count)

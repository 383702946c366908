"""Shapes to make assets of, and the asset itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...scene.mesh import Mesh, mesh_from_faces
from ...spatial.part_boxes import mesh_parts
from ..occupancy import Shapes

Vector = Sequence[float]


class Solid(NamedTuple):
    """A closed shape of one material: points (V, 3) and faces, counter-clockwise from outside."""

    material: str
    points: NDArray[np.float64]
    faces: list[list[int]]


@dataclass(frozen=True)
class StandingSurface:
    """A level rectangle on which objects may stand: ``center`` and ``size`` (x, y) in the asset's frame, metres."""

    center: tuple[float, float, float]
    size: tuple[float, float]
    headroom: float = np.inf


@dataclass(frozen=True, eq=False)
class Furniture:
    """A kind of object: its category, mesh and the surfaces it offers to others."""

    category: str
    mesh: Mesh
    surfaces: Mapping[str, StandingSurface] = field(default_factory=dict)

    @cached_property
    def shapes(self) -> Shapes:
        """The boxes around the mesh's connected parts."""
        parts = mesh_parts(self.mesh)
        return Shapes(parts.mean(axis=1), (parts[:, 1] - parts[:, 0]) / 2)

    @cached_property
    def size(self) -> NDArray[np.float64]:
        """float64 (3,): width, depth and height of the whole."""
        return self.mesh.bounds[1] - self.mesh.bounds[0]


def asset(
    category: str,
    parts: Sequence[Solid],
    surfaces: Mapping[str, StandingSurface] | None = None,
    *,
    origin: str = "bottom",
) -> Furniture:
    """Join parts to an asset and move its origin to the middle of its "bottom" or "top", or leave it ("own")."""
    lowest = np.min([part.points.min(axis=0) for part in parts], axis=0)
    highest = np.max([part.points.max(axis=0) for part in parts], axis=0)
    middle = (lowest + highest) / 2
    middle[2] = highest[2] if origin == "top" else lowest[2]
    middle *= origin != "own"
    moved = {
        name: StandingSurface(tuple(np.subtract(surface.center, middle).tolist()), surface.size, surface.headroom)
        for name, surface in (surfaces or {}).items()
    }
    return Furniture(category, _join(category, parts, middle), moved)


def _join(name: str, parts: Sequence[Solid], origin: NDArray[np.float64]) -> Mesh:
    starts = np.cumsum([0, *(len(part.points) for part in parts[:-1])]).tolist()
    faces = [[start + i for i in face] for start, part in zip(starts, parts, strict=True) for face in part.faces]
    bare = mesh_from_faces(name, np.concatenate([part.points for part in parts]) - origin, faces)
    slots = tuple(dict.fromkeys(part.material for part in parts))
    index = np.repeat([slots.index(part.material) for part in parts], [len(part.faces) for part in parts])
    return Mesh(name, bare.points, bare.corners, bare.offsets, material_index=index.astype(np.int32), materials=slots)


def block(material: str, size: Vector, at: Vector = (0, 0, 0), taper: float = 1.0) -> Solid:
    """A box of ``size`` with the centre of its bottom ``at`` a point; its top is ``taper`` times as large."""
    half = np.array(size[:2]) / 2
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half
    return prism(material, square, at[2], at[2] + size[2], at=at[:2], taper=taper)


def prism(
    material: str,
    outline: Sequence[Vector] | NDArray[np.floating],
    low: float,
    high: float,
    at: Vector = (0, 0),
    taper: float = 1.0,
) -> Solid:
    """A counter-clockwise outline (K, 2), moved to ``at``, between two heights; its top is ``taper`` times as large.

    All of the outline must be visible from its first point: faces are cut into fans of triangles there.
    """
    base = np.asarray(outline, np.float64)
    count = len(base)
    rings = [np.column_stack([base * scale + at, np.full(count, z)]) for scale, z in ((1.0, low), (taper, high))]
    sides = [[i, (i + 1) % count, count + (i + 1) % count, count + i] for i in range(count)]
    caps = [[0, *range(count - 1, 0, -1)], list(range(count, 2 * count))]
    return Solid(material, np.concatenate(rings), sides + caps)


def rod(
    material: str, radius: float, start: Vector, end: Vector, sides: int = 8, end_radius: float | None = None
) -> Solid:
    """A round bar between two points; with another ``end_radius`` a cone's frustum."""
    first, last = np.asarray(start, np.float64), np.asarray(end, np.float64)
    along = (last - first) / np.linalg.norm(last - first)
    across = np.eye(3)[np.argmin(np.abs(along))]
    u = np.cross(across, along)
    u /= np.linalg.norm(u)
    ring = _circle(sides) @ np.stack([u, np.cross(along, u)])
    points = np.concatenate([first + radius * ring, last + (radius if end_radius is None else end_radius) * ring])
    walls = [[i, (i + 1) % sides, sides + (i + 1) % sides, sides + i] for i in range(sides)]
    return Solid(material, points, [*walls, list(range(sides))[::-1], list(range(sides, 2 * sides))])


def lathe(material: str, profile: Sequence[Vector], at: Vector = (0, 0, 0), sides: int = 12) -> Solid:
    """A closed shape turned about z: ``profile`` goes from the axis at the bottom to the axis at the top, as (r, z)."""
    (_, bottom), (_, top) = profile[0], profile[-1]
    inner = profile[1:-1]
    rings = [np.column_stack([radius * _circle(sides), np.full(sides, z)]) for radius, z in inner]
    points = np.concatenate([[[0, 0, bottom]], *rings, [[0, 0, top]]]) + at
    faces = []
    for i in range(sides):
        j = (i + 1) % sides
        faces.append([0, 1 + j, 1 + i])
        for ring in range(len(inner) - 1):
            a, b = 1 + ring * sides, 1 + (ring + 1) * sides
            faces.append([a + i, a + j, b + j, b + i])
        last = 1 + (len(inner) - 1) * sides
        faces.append([last + i, last + j, len(points) - 1])
    return Solid(material, points, faces)


def ball(material: str, radii: Vector, at: Vector, sides: int = 10, rings: int = 5) -> Solid:
    """An ellipsoid around the point ``at``."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, rings + 2)
    unit = lathe(material, np.column_stack([np.cos(angles), np.sin(angles)]).tolist(), sides=sides)
    return Solid(material, unit.points * np.asarray(radii) + at, unit.faces)


def turned(part: Solid, degrees: float, about: Vector = (0, 0)) -> Solid:
    """The part turned about the vertical axis through ``about``."""
    angle = np.radians(degrees)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    points = part.points.copy()
    points[:, :2] = (points[:, :2] - about) @ turn.T + about
    return Solid(part.material, points, part.faces)


def _circle(sides: int) -> NDArray[np.float64]:
    angles = 2 * np.pi * (np.arange(sides) + 0.5) / sides
    return np.column_stack([np.cos(angles), np.sin(angles)])

"""Rooms whose structure is known, in the forms that users have: built for tests."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from unisg_blender.geometry.planar import turn
from unisg_blender.geometry.polygon import area, inside
from unisg_blender.scene import Mesh, SceneBuilder, SceneGraph, mesh_from_faces

FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]

SQUARE = np.array([[0, 0], [5, 0], [5, 4], [0, 4]], float)
L_SHAPE = np.array([[0, 0], [6, 0], [6, 3], [3, 3], [3, 5], [0, 5]], float)
TRIANGLE = np.array([[0, 0], [6, 0], [1, 5]], float)
ROUND = 3 * np.array([[np.cos(a), np.sin(a)] for a in np.linspace(0, 2 * np.pi, 24, endpoint=False)])
CORRIDOR = np.array([[0, 0], [9, 0], [9, 1.2], [0, 1.2]], float)
OUTLINES = {"square": SQUARE, "l": L_SHAPE, "triangle": TRIANGLE, "round": ROUND, "corridor": CORRIDOR}


@dataclass(frozen=True, eq=False)
class Hole:
    """An opening in the wall along edge ``edge``, from ``start`` to ``stop`` metres along it, at these heights."""

    edge: int
    start: float
    stop: float
    bottom: float = 0.0
    top: float = 2.0


DOOR, WINDOW = Hole(0, 1.0, 1.9), Hole(1, 1.0, 2.2, 0.9, 2.0)


def box(low, high) -> tuple[np.ndarray, list[list[int]]]:
    low, high = np.array(low, float), np.array(high, float)
    points = [[(low, high)[i][0], (low, high)[j][1], (low, high)[k][2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    return np.array(points), FACES


def slab(outline: np.ndarray, bottom: float, top: float):
    """A polygon as a slab, or as a sheet where bottom and top are the same."""
    count = len(outline)
    upper = np.column_stack([outline, np.full(count, top)])
    if bottom == top:
        return upper, [list(range(count))]
    lower = np.column_stack([outline, np.full(count, bottom)])
    sides = [[i, (i + 1) % count, count + (i + 1) % count, count + i] for i in range(count)]
    faces = [list(range(count))[::-1], [count + i for i in range(count)], *sides]
    return np.concatenate([lower, upper]), faces


def triangulated(outline: np.ndarray, z: float):
    """A polygon of any shape as triangles, by ears."""
    left, faces = list(range(len(outline))), []
    while len(left) > 3:
        for place in range(len(left)):
            a, b, c = (left[(place + step) % len(left)] for step in range(3))
            ear, rest = outline[[a, b, c]], [n for n in left if n not in (a, b, c)]
            if area(ear) > 1e-9 and not inside(ear, outline[rest]).any():
                faces.append([a, b, c])
                left.remove(b)
                break
    return np.column_stack([outline, np.full(len(outline), z)]), [*faces, left]


def walls(outline: np.ndarray, bottom: float, top: float, thickness: float, holes: tuple[Hole, ...] = ()):
    """The walls along a polygon, outside it, as pieces: (points, faces) of each edge; thickness 0 makes sheets."""
    found = []
    for edge, (start, stop) in enumerate(zip(outline, np.roll(outline, -1, axis=0), strict=True)):
        length = float(np.linalg.norm(stop - start))
        along = (stop - start) / length
        out = np.array([along[1], -along[0]])
        cuts = [hole for hole in holes if hole.edge == edge]
        marks = sorted({0.0, length, *(hole.start for hole in cuts), *(hole.stop for hole in cuts)})
        pieces = []
        convex = [_turns_left(outline, corner) for corner in (edge, (edge + 1) % len(outline))]
        for a, b in pairwise(marks):
            hole = next((hole for hole in cuts if hole.start <= (a + b) / 2 <= hole.stop), None)
            spans = [(bottom, top)] if hole is None else [(bottom, bottom + hole.bottom), (bottom + hole.top, top)]
            for low, high in spans:
                if high > low:
                    ends = thickness * (a == 0) * convex[0], thickness * (b == length) * convex[1]
                    pieces.append((a - ends[0], b + ends[1], low, high))
        parts = []
        for a, b, low, high in pieces:
            ends = [start + a * along, start + b * along]
            if thickness == 0:
                points = np.array([[*ends[i], z] for i, z in ((0, low), (1, low), (1, high), (0, high))])
                parts.append((points, [[3, 2, 1, 0]]))
            else:
                corners = [ends[0], ends[1], ends[1] + thickness * out, ends[0] + thickness * out]
                parts.append(slab(np.array(corners)[::-1], low, high))
        found.append(joined(parts))
    return found


def _turns_left(outline: np.ndarray, corner: int) -> bool:
    before, after = outline[corner] - outline[corner - 1], outline[(corner + 1) % len(outline)] - outline[corner]
    return bool(before[0] * after[1] > before[1] * after[0])


def joined(parts):
    """Several (points, faces) as one."""
    shift = np.cumsum([0, *(len(points) for points, _ in parts)])
    faces = [[corner + start for corner in face] for (_, own), start in zip(parts, shift, strict=False) for face in own]
    return np.concatenate([points for points, _ in parts]), faces


def mesh(part) -> Mesh:
    return mesh_from_faces("Part", *part)


def table(x: float, y: float, z: float, yaw: float = 0.0):
    """A table of 1.2 x 0.8 m with four legs, 0.75 m high."""
    parts = [box((-0.6, -0.4, 0.7), (0.6, 0.4, 0.75))]
    parts += [box((a - 0.03, b - 0.03, 0), (a + 0.03, b + 0.03, 0.7)) for a in (-0.5, 0.5) for b in (-0.3, 0.3)]
    points, faces = joined(parts)
    return points @ turn(yaw)[:3, :3].T + (x, y, z), faces


def scene(objects: dict, move: np.ndarray | None = None, baked: bool = True) -> SceneGraph:
    """A scene of named (points, faces); ``move`` (4, 4) is applied to the points, or to the objects."""
    matrix = np.eye(4) if move is None else move
    builder = SceneBuilder("Built")
    for name, (points, faces) in objects.items():
        if baked:
            points = points @ matrix[:3, :3].T + matrix[:3, 3]
            flipped = np.linalg.det(matrix[:3, :3]) < 0
            faces = [face[::-1] for face in faces] if flipped else faces
        builder.add(name, uid=name, mesh=mesh((points, faces)), local=np.eye(4) if baked else matrix)
    return builder.build()


def room(outline: np.ndarray, thickness: float = 0.1, height: float = 2.5, roof: bool = False, holes=(), one: str = ""):
    """The objects of a room: ``one`` is "" for an object each, "walls" or "all" for one mesh of them."""
    around = outline if not thickness else grown(outline, thickness)
    floor = slab(around, -0.1, 0.0) if len(outline) == 4 else triangulated(around, 0.0)
    objects = {"ground": floor}
    sides = walls(outline, 0.0, height, thickness, holes)
    objects |= {"side": joined(sides)} if one else {f"side {number}": part for number, part in enumerate(sides)}
    if roof:
        objects["top"] = slab(around, height, height + 0.1) if len(outline) == 4 else triangulated(around, height)
    return {"house": joined(list(objects.values()))} if one == "all" else objects


def grown(outline: np.ndarray, by: float) -> np.ndarray:
    """A polygon with its edges moved outwards."""
    before, after = outline - np.roll(outline, 1, axis=0), np.roll(outline, -1, axis=0) - outline
    normals = []
    for way in (before, after):
        unit = way / np.linalg.norm(way, axis=1, keepdims=True)
        normals.append(np.stack([unit[:, 1], -unit[:, 0]], axis=1))
    both = normals[0] + normals[1]
    return outline + by * both * (2 / (both**2).sum(axis=1, keepdims=True))


def overlap(first, second, step: float = 0.02) -> float:
    """Intersection over union of two shapes, each (outline, *holes), by points on a grid."""
    corners = np.concatenate([first[0], second[0]])
    low, high = corners.min(axis=0), corners.max(axis=0)
    points = np.stack(np.meshgrid(*(np.arange(low[k] + step / 2, high[k], step) for k in (0, 1))), axis=-1).reshape(
        -1, 2
    )
    one, two = (_inside(shape, points) for shape in (first, second))
    return float((one & two).sum() / max((one | two).sum(), 1))


def _inside(shape, points):
    found = inside(shape[0], points)
    for hole in shape[1:]:
        found &= ~inside(hole, points)
    return found


def grid_mesh(count: int, size: float, height) -> Mesh:
    """A square of so many points a side, its heights a function of x and y."""
    side = np.linspace(-size / 2, size / 2, count)
    x, y = (part.ravel() for part in np.meshgrid(side, side))
    row, column = np.divmod(np.arange((count - 1) ** 2), count - 1)
    corner = row * count + column
    faces = np.stack([corner, corner + 1, corner + count + 1, corner + count], axis=1).astype(np.int32)
    points = np.column_stack([x, y, height(x, y)]).astype(np.float32)
    return Mesh("Grid", points, faces.reshape(-1), (np.arange(len(faces) + 1) * 4).astype(np.int32))


def of_mesh(found: Mesh) -> SceneGraph:
    builder = SceneBuilder("Built")
    builder.add("thing", uid="thing", mesh=found)
    return builder.build()

"""Rooms out of what layout files say: boxes of true size, floors, walls with their openings, what stands on what."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError
from ..scene import Mesh, SceneBuilder, SceneGraph, box_mesh, entry_table, mesh_from_faces
from ..scene.components import RELATIONS
from .axes import LARGEST, Array, numbers, pose

THINNEST = 1e-3
"""Metres: no box is thinner."""

SLAB = 0.1
"""Metres: floors reach so far down."""

SHEET = 0.04
"""Metres: walls, where a file has them as sheets; what is in them is half as thick again."""

MOST_ENTITIES = 200_000


@dataclass
class RoomBuilder:
    """Collects the entities of a room; names are categories with a number, as Blender writes them."""

    title: str
    _builder: SceneBuilder = field(init=False)
    _counts: dict[str, int] = field(default_factory=dict)
    _boxes: dict[tuple[float, ...], Mesh] = field(default_factory=dict)
    _uids: dict[str, int] = field(default_factory=dict)
    _relations: list[tuple[str, str, str]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._builder = SceneBuilder(self.title)

    def add(
        self, category: str, local: Array, mesh: Mesh | None = None, *, uid: str = "", parent: int = -1,
        name: str = "", others: Mapping[str, Any] | None = None,
    ) -> int:  # fmt: skip
        """Add an entity with any mesh; returns its number.

        ``uid`` is what the file calls it, by which relations refer to it. Raises UniSGError if there are more than
        :data:`MOST_ENTITIES`, ValueError if the matrix is not finite.
        """
        if len(self._uids) >= MOST_ENTITIES:
            raise UniSGError(f"a scene of more than {MOST_ENTITIES:,} entities is not read")
        if not (np.abs(local) < LARGEST).all():
            raise ValueError(f"the pose of {uid or category!r} is not finite")
        stem = name or category or "Object"
        self._counts[stem] = number = self._counts.get(stem, -1) + 1
        label = f"{stem}.{number:03d}" if number else stem
        uid = uid or label
        uid = uid if uid not in self._uids else f"{uid} ({label})"
        entity = self._builder.add(
            label, uid=uid, parent=parent, local=local, mesh=mesh, category=category, others=others
        )
        self._uids[uid] = entity
        return entity

    def box(self, category: str, size: Array, local: Array, **options: Any) -> int:
        """Add a box (3,) that stands on the origin of its frame; options as in :meth:`add`."""
        return self.add(category, local, self.box_mesh(category, size, 0.0), **options)

    def centred_box(self, category: str, size: Array, local: Array, **options: Any) -> int:
        """Add a box (3,) around the origin of its frame; options as in :meth:`add`."""
        return self.add(category, local, self.box_mesh(category, size, -0.5), **options)

    def box_mesh(self, name: str, size: Array, bottom: float) -> Mesh:
        """The mesh of a box whose bottom is ``bottom`` heights above the origin; boxes of one size share it."""
        size = np.maximum(numbers(size, 3), THINNEST)
        key = (*size.tolist(), bottom)
        if key not in self._boxes:
            self._boxes[key] = box_mesh(name, size, bottom)
        return self._boxes[key]

    def floor(self, outline: Array, category: str = "Floor", thick: float = -SLAB, **options: Any) -> int:
        """Add a slab below (a ceiling: above, ``thick`` > 0) a level outline (K, 3); options as in :meth:`add`."""
        mesh = prism(category, np.asarray(outline, np.float64)[:, :2], *sorted((0.0, thick)))
        return self.add(category, pose((0, 0, float(np.mean(np.asarray(outline)[:, 2])))), mesh, **options)

    def wall(
        self,
        start: Array,
        stop: Array,
        height: float,
        thick: float = SHEET,
        inside: Array | None = None,
        **options: Any,
    ) -> Array:
        """Add a wall between two points on the ground (3,); returns its frame (4, 4): x along it, y through it, z up.

        It stands outside the line where ``inside`` is a point of the room, else across it. ValueError without length.
        """
        frame, length = wall_frame(start, stop)
        out = 0.0
        if inside is not None:
            out = -thick / 2 * float(np.sign((np.asarray(inside) - start) @ frame[:3, 1]) or -1.0)
        self.in_wall("Wall", frame, (0.0, length), (0.0, height), thick, out, **options)
        return frame

    def in_wall(
        self, category: str, frame: Array, along: Iterable[float], up: Iterable[float], thick: float = 1.5 * SHEET,
        out: float = 0.0, **options: Any,
    ) -> int:  # fmt: skip
        """Add a door, a window or a piece of wall in the frame of a wall; ``along`` and ``up`` are two numbers each."""
        (left, right), (low, high) = sorted(along), sorted(up)
        local = frame @ pose(((left + right) / 2, out, low))
        return self.box(category, np.array([right - left, thick, high - low]), local, **options)

    def relate(self, subject: str, kind: str, target: str) -> None:
        """Say that what the file calls ``subject`` stands in ``kind`` to ``target``; either may be added later."""
        self._relations.append((subject, kind, target))

    def build(self) -> SceneGraph:
        """The scenegraph; relations to what is not there are left out."""
        graph = self._builder.build()
        rows = graph.row_of_uid
        known = {(rows[a], kind, b) for a, kind, b in self._relations if a in rows and b in rows and a != b}
        return graph.with_component(RELATIONS, entry_table(sorted(known), "kind", "target"))


def prism(name: str, outline: Array, low: float, high: float) -> Mesh:
    """A polygon (K, 2), in either direction, between two heights."""
    if len(outline) < 3 or not (np.abs(outline) < LARGEST).all():
        raise ValueError("an outline has fewer than three corners, or they are not finite")
    before = np.roll(outline, 1, axis=0)
    if (before[:, 0] * outline[:, 1] - before[:, 1] * outline[:, 0]).sum() < 0:
        outline = outline[::-1]
    count, steps = len(outline), np.arange(len(outline))
    points = np.concatenate([np.column_stack([outline, np.full(count, height)]) for height in (low, high)])
    sides = np.stack([steps, (steps + 1) % count, count + (steps + 1) % count, count + steps], axis=1)
    return mesh_from_faces(name, points, [steps[::-1].tolist(), (count + steps).tolist(), *sides.tolist()])


def wall_frame(start: Array, stop: Array) -> tuple[Array, float]:
    """The frame (4, 4) at the start of a wall, and its length; ValueError if it has none."""
    start, stop = numbers(start, 3), numbers(stop, 3)
    length = float(np.hypot(*(stop - start)[:2]))
    if length < 1e-9:
        raise ValueError("a wall has no length")
    x, y = (stop - start)[:2] / length
    frame = pose(start)
    frame[:2, :2] = [[x, -y], [y, x]]
    return frame, length


def upright_box(low: Array, high: Array) -> tuple[Array, Array]:
    """Pose (4, 4) of the bottom's middle and size (3,) of an axis-aligned box."""
    return pose(((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2])), high - low


def oriented_box(corners: NDArray[np.float64]) -> tuple[Array, Array]:
    """Pose and size of an oriented box by its eight corners: the bottom ring, then the top one."""
    edges = corners[[1, 3, 4]] - corners[0]
    size = np.linalg.norm(edges, axis=1)
    if (size < THINNEST).any():
        return upright_box(corners.min(axis=0), corners.max(axis=0))
    axes = (edges / size[:, None]).T
    if np.linalg.det(axes) < 0:
        axes[:, 0] *= -1
    return pose(corners.mean(axis=0) - axes[:, 2] * size[2] / 2, axes), size

"""What is an object: which rows of a scene make one, and the boxes around them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..geometry.arrays import Bools, Floats, Ints
from ..geometry.boxes import Boxes, orthonormal_axes, upright_boxes
from ..geometry.corner_ends import corner_ends
from ..geometry.planar import heading
from ..geometry.polygon import convex_hull
from ..geometry.surface_contact import Triangles
from ..scene.components import VISIBILITY
from ..scene.graph import SceneGraph
from ..scene.hierarchy import subtree, world_matrices
from ..scene.structure_marks import NOTHING, PART_MARK, THING, marks
from .part_boxes import PartBoxes, part_boxes


def object_rows(graph: SceneGraph) -> Ints:
    """int64 (N,): for each entity the row of the object that it is or belongs to, -1 for none.

    An object is an entity with a category, or one with a mesh that hangs under none. What
    has no category belongs to the nearest entity above that has one.
    """
    category, mesh = graph.category.tolist(), graph.mesh.tolist()
    found: list[int] = []
    for row, parent in enumerate(graph.parent.tolist()):  # parents come first
        above = found[parent] if parent >= 0 else -1
        if category[row] < 0 and above >= 0 and category[above] >= 0:
            found.append(above)
        else:
            found.append(row if category[row] >= 0 or mesh[row] >= 0 else -1)
    return np.array(found, np.int64)


@dataclass(frozen=True, eq=False)
class Objects:
    """The objects of a scene, K of them; their boxes are worked out when they are asked for, in world metres.

    Attributes
    ----------
    graph
        The scene, N rows.
    rows
        int64 (K,): row of each object's entity, ascending.
    of_row
        int64 (N,): number of the object that a row is or belongs to, -1 for none.
    """

    graph: SceneGraph
    rows: Ints
    of_row: Ints

    def __len__(self) -> int:
        return len(self.rows)

    @cached_property
    def world(self) -> Floats:
        """World matrices of all rows of the scene, (N, 4, 4)."""
        return world_matrices(self.graph)

    @cached_property
    def meshes(self) -> list[Ints]:
        """Rows of the meshes with points of each object, ascending."""
        rows = np.flatnonzero(shown(self.graph) & (self.of_row >= 0))
        rows = rows[np.argsort(self.of_row[rows], kind="stable")]
        return np.split(rows, np.searchsorted(self.of_row[rows], np.arange(1, len(self)))) if len(self) else []

    @cached_property
    def axes(self) -> Floats:
        """The objects' own axes as columns, (K, 3, 3)."""
        return orthonormal_axes(self.world[self.rows, :3, :3])

    @cached_property
    def bounds(self) -> Floats:
        """Lowest and highest corner along the world's axes, exact, (2, K, 3)."""
        return self._bounds(np.broadcast_to(np.eye(3), (len(self), 3, 3)))

    @property
    def low(self) -> Floats:
        """Lowest corners along the world's axes, (K, 3)."""
        return self.bounds[0]

    @property
    def high(self) -> Floats:
        """Highest corners along the world's axes, (K, 3)."""
        return self.bounds[1]

    @cached_property
    def aligned(self) -> Boxes:
        """The boxes along the world's axes."""
        axes = np.broadcast_to(np.eye(3), (len(self), 3, 3))
        return Boxes((self.low + self.high) / 2, axes, (self.high - self.low) / 2, np.ones(len(self), bool))

    @cached_property
    def oriented(self) -> Boxes:
        """The tightest boxes along the objects' own axes."""
        low, high = self._bounds(self.axes)
        center = np.einsum("kij,kj->ki", self.axes, (low + high) / 2)
        return Boxes(center, self.axes, (high - low) / 2, np.ones(len(self), bool))

    def _bounds(self, axes: Floats) -> Floats:
        """Lowest and highest corner of each object seen along axes of its own (K, 3, 3); its origin without points."""
        found = np.empty((2, len(self), 3))
        for obj, rows in enumerate(self.meshes):
            points = [self.world[[self.rows[obj]], :3, 3]] if not len(rows) else []
            for row in rows:
                moved = self.graph.meshes[self.graph.mesh[row]].points @ self.world[row, :3, :3].T
                moved = moved + self.world[row, :3, 3]
                moved = moved[np.isfinite(moved).all(axis=1)]
                points.append(moved if len(moved) else self.world[[row], :3, 3])
            seen = np.concatenate(points) @ axes[obj]
            found[:, obj] = seen.min(axis=0), seen.max(axis=0)
        return found

    def footprint(self, obj: int) -> Floats:
        """The convex hull of an object seen from above, (C, 2) metres."""
        if obj not in self._footprints:
            self._footprints[obj] = convex_hull(self.triangles(obj).reshape(-1, 3)[:, :2])
        return self._footprints[obj]

    @cached_property
    def _footprints(self) -> dict[int, Floats]:
        return {}

    @cached_property
    def parts(self) -> PartBoxes:
        """World boxes of the connected parts of the meshes, each with the number of its object, ascending."""
        found = part_boxes(self.graph)
        owner = np.where(shown(self.graph), self.of_row, -1)[found.owner]
        order = np.argsort(owner, kind="stable")
        order = order[owner[order] >= 0]
        return PartBoxes(found.boxes.take(order), owner[order])

    @cached_property
    def yaw(self) -> Floats:
        """Turns about the vertical, radians (K,)."""
        return heading(self.world[self.rows, :3, :3])

    @cached_property
    def upright(self) -> tuple[Floats, Floats]:
        """Centres and half extents (K, 3) of the boxes around the parts that are turned by ``yaw`` only."""
        return upright_boxes(self.parts.boxes, self.parts.owner, self.yaw, self.world[self.rows, :3, 3])

    @cached_property
    def above(self) -> Ints:
        """int64 (K,): the next object up the hierarchy, -1 for none."""
        nearest: list[int] = []
        own = np.full(len(self.graph), -1, np.int64)
        own[self.rows] = np.arange(len(self))
        for parent in self.graph.parent.tolist():  # parents come first
            nearest.append(-1 if parent < 0 else int(own[parent]) if own[parent] >= 0 else nearest[parent])
        return np.array(nearest, np.int64)[self.rows]

    def is_below(self, one: int, two: int) -> bool:
        """True if object ``one`` hangs under object ``two`` in the hierarchy."""
        place = int(self.above[one])
        while place >= 0 and place != two:
            place = int(self.above[place])
        return place == two

    def triangles(self, obj: int) -> Triangles:
        """World triangles of an object, float64 (M, 3, 3); those with points that are no numbers are left out."""
        if obj not in self._made:
            corners = np.concatenate([np.zeros((0, 3, 3)), *(self._triangles(row) for row in self.meshes[obj])])
            self._made[obj] = corners[np.isfinite(corners).all(axis=(1, 2))]
        return self._made[obj]

    def triangles_within(self, obj: int, low: Floats, high: Floats) -> Triangles:
        """The triangles of an object whose boxes reach into an axis-aligned box."""
        triangles = self.triangles(obj)
        if obj not in self._ends:
            self._ends[obj] = corner_ends(triangles)
        lowest, highest = self._ends[obj]
        return triangles[((lowest <= high) & (highest >= low)).all(axis=1)]

    @cached_property
    def _ends(self) -> dict[int, tuple[Floats, Floats]]:
        return {}

    @cached_property
    def _made(self) -> dict[int, Triangles]:
        return {}

    def _triangles(self, row: int) -> Triangles:
        mesh, matrix = self.graph.meshes[self.graph.mesh[row]], self.world[row]
        points = mesh.points.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
        mirrored = np.linalg.det(matrix[:3, :3]) < 0
        return points[mesh.triangles[:, ::-1] if mirrored else mesh.triangles]


def find_objects(graph: SceneGraph, empty: bool = True) -> Objects:
    """The objects of a scene, see :func:`object_rows`.

    With ``empty`` a category without geometry counts: it can be referred to, and holds or plays something. Relations
    of place, collisions and boxes are told of what has geometry only.
    """
    owner = object_rows(graph)
    if not empty:
        owner = np.where(shown(graph), owner, -1)
    rows = np.unique(owner[owner >= 0])
    of_row = np.where(owner >= 0, np.searchsorted(rows, owner), -1)
    return Objects(graph, rows, of_row)


def shown(graph: SceneGraph) -> Bools:
    """Which rows have a mesh with points that is there, bool (N,): not what neither viewport nor render shows, nor what
    is marked as nothing."""
    found = np.array([len(mesh.points) > 0 for mesh in graph.meshes] + [False], bool)[graph.mesh]
    visibility = graph.components.get(VISIBILITY)
    if visibility is not None:
        columns = visibility.columns
        found[visibility.rows[(columns["hidden"] | columns["viewport"]) & columns["render"]]] = False
    return found & ~_marked(graph, NOTHING)


def marked_things(graph: SceneGraph) -> Bools:
    """Which rows the user marked as no building, with what hangs under them, bool (N,)."""
    return _marked(graph, THING)


def _marked(graph: SceneGraph, wanted: str) -> Bools:
    found = np.zeros(len(graph), bool)
    for row, mark in marks(graph, PART_MARK).items():
        if mark == wanted:
            found[subtree(graph, row)] = True
    return found

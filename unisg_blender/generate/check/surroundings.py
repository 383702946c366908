"""What is around a thing that is judged: the triangles of a scene, its room, its doorways."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.boxes import Boxes
from ...geometry.corner_ends import corner_ends, meeting_ends
from ...geometry.grouped_ends import grouped_ends
from ...scene import SceneGraph
from ...spatial.structure.doorways import doorways
from ...spatial.structure.room_objects import RoomObjects, room_objects
from ...spatial.structure.scan import world_triangles


@dataclass(frozen=True, eq=False)
class Surroundings:
    """All triangles (M, 3, 3) of a scene in the world with their rows (M,), ascending, its room and its doorways."""

    graph: SceneGraph
    triangles: Floats
    row: Ints
    room: RoomObjects
    doors: Boxes

    @cached_property
    def ends(self) -> tuple[Floats, Floats]:
        """Least and greatest coordinates (M, 3) of each triangle."""
        return corner_ends(self.triangles)

    @cached_property
    def row_ends(self) -> tuple[Floats, Floats]:
        """Least and greatest coordinates (N, 3) of what each row shows; infinite, the wrong way round, for nothing."""
        return grouped_ends(self.row, len(self.graph), *self.ends)

    def near(self, low: Floats, high: Floats) -> Ints:
        """The numbers of the triangles that reach into a box, looked for among those of the rows that do."""
        some = self.of_rows(np.flatnonzero(meeting_ends(*self.row_ends, low, high)))
        return some[meeting_ends(self.ends[0][some], self.ends[1][some], low, high)]

    def of_rows(self, rows: Ints) -> Ints:
        """The numbers of the triangles of some rows, which ascend."""
        first = self._first
        return np.concatenate([np.arange(0), *(np.arange(first[row], first[row + 1]) for row in rows.tolist())])

    @cached_property
    def _first(self) -> Ints:
        """The number (N + 1,) of the first triangle of each row."""
        return np.searchsorted(self.row, np.arange(len(self.graph) + 1))

    @staticmethod
    def of(graph: SceneGraph, before: SceneGraph) -> Surroundings:
        """A scene to be judged; its rooms are those that it had ``before`` things were put into it."""
        triangles, row = world_triangles(graph)
        room = room_objects(before, ())
        return Surroundings(graph, triangles, row, room, doorways(room.structure.rooms if room.structure else ()))


@dataclass(frozen=True, eq=False)
class PosedThing:
    """A thing where it stands, or could: its triangles (M, 3, 3) in the world, metres, and its matrix (4, 4).

    ``skipped`` bool (N,) are rows of the scene that do not count, its own among them; ``holders`` the rows of what it
    is ``held`` by without standing on it, ``inside`` that or not.
    """

    triangles: Floats
    matrix: Floats
    skipped: Bools
    holders: Ints
    held: bool = False
    inside: bool = False

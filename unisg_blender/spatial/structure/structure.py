"""What is building in a scene: rooms with their floors, ceilings, walls and openings, and what can hold things."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import Bools, Floats
from ...geometry.polygon import area, inside, to_edges


@dataclass(frozen=True, eq=False)
class Opening:
    """A door, window or passage in a wall, from ``start`` to ``stop`` (2,) at heights ``bottom`` to ``top``, metres."""

    kind: str
    start: Floats
    stop: Floats
    bottom: float
    top: float


@dataclass(frozen=True, eq=False)
class WallPiece:
    """A straight piece of wall along a room: its face towards the room runs from ``start`` to ``stop`` (2,), metres.

    The room is on the left of the way. ``thickness`` is 0 for one-sided walls; ``row`` is the entity that most of it
    belongs to.
    """

    start: Floats
    stop: Floats
    thickness: float
    bottom: float
    top: float
    row: int

    @property
    def length(self) -> float:
        """Metres along the wall."""
        return float(np.linalg.norm(self.stop - self.start))


@dataclass(frozen=True, eq=False)
class Room:
    """A region of a floor, bounded by walls or by the floor's edge.

    Attributes
    ----------
    outline, holes
        Polygons (K, 2), metres: counter-clockwise, and what is cut out of it.
    floor, ceiling
        Heights in metres; the ceiling's is infinite where there is none.
    storey
        0 for the lowest floor, and so on.
    indoors
        False for an open place: a floor without a building around it.
    floor_row, ceiling_row
        Rows of the entities that the floor and the ceiling belong to, -1 for none.
    walls, openings
        The walls along the outline, in its order, and what is open in them.
    """

    outline: Floats
    holes: tuple[Floats, ...]
    floor: float
    ceiling: float
    storey: int
    indoors: bool
    floor_row: int
    ceiling_row: int
    walls: tuple[WallPiece, ...] = ()
    openings: tuple[Opening, ...] = ()

    @property
    def area(self) -> float:
        """Square metres of floor."""
        return abs(area(self.outline)) - sum(abs(area(hole)) for hole in self.holes)

    @property
    def inner_point(self) -> Floats:
        """A point (2,) of the floor far from its rim."""
        low, high = self.outline.min(axis=0), self.outline.max(axis=0)
        steps = (np.arange(GRID) + 0.5) / GRID
        points = low + (high - low) * np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
        mine = points[self.contains(points)]
        if not len(mine):
            return np.asarray(self.outline.mean(axis=0))
        ways = np.concatenate([to_edges(loop, mine) for loop in (self.outline, *self.holes)], axis=1)
        return np.asarray(mine[np.linalg.norm(ways, axis=2).min(axis=1).argmax()])

    def contains(self, points: Floats) -> Bools:
        """Which points (..., 2) are over the floor of the room."""
        found = inside(self.outline, points)
        for hole in self.holes:
            found &= ~inside(hole, points)
        return found


@dataclass(frozen=True, eq=False)
class HoldingSurface:
    """A level surface of entity ``row`` on which things can stand: ``outline`` (K, 2), height and headroom, metres.

    ``room`` is the number of the room that it is in.
    """

    row: int
    outline: Floats
    height: float
    headroom: float
    room: int

    @property
    def area(self) -> float:
        """Square metres."""
        return abs(area(self.outline))


@dataclass(frozen=True, eq=False)
class Structure:
    """What was recognised in a scene.

    Attributes
    ----------
    rooms
        Storey by storey from below, the largest first.
    surfaces
        Surfaces in these rooms that can hold things.
    cell
        Metres within which things were looked for: what is thinner may have been missed.
    notes
        What a user should know, a sentence each: why nothing was found, what was left out.
    """

    rooms: tuple[Room, ...]
    surfaces: tuple[HoldingSurface, ...]
    cell: float
    notes: tuple[str, ...]

    @property
    def storeys(self) -> int:
        """Number of floors above one another."""
        return len({room.storey for room in self.rooms})

    @property
    def parts(self) -> dict[int, tuple[str, ...]]:
        """By row the categories of what it is, in the order floor, wall, ceiling."""
        found: dict[int, list[str]] = {}
        for kind, rows in (
            ("Floor", [room.floor_row for room in self.rooms]),
            ("Wall", [wall.row for room in self.rooms for wall in room.walls]),
            ("Ceiling", [room.ceiling_row for room in self.rooms]),
        ):
            for row in dict.fromkeys(rows):
                if row >= 0:
                    found.setdefault(row, []).append(kind)
        return {row: tuple(kinds) for row, kinds in sorted(found.items())}

    def room_at(self, point: Floats) -> int:
        """The number of the room that a point (3,) is in, -1 for none."""
        for number, room in enumerate(self.rooms):
            if room.floor - BELOW <= point[2] < min(room.ceiling, room.floor + TALLEST) and room.contains(point[:2]):
                return number
        return -1


GRID = 32
"""Steps along each side of a room in which its inner point is looked for."""

BELOW = 0.3
"""Metres below its floor where things still count as in a room: they are sunk in."""

TALLEST = 12.0
"""Metres of height that a room has at most."""

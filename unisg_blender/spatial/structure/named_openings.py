"""Doors and windows that users name by a category: each is an opening of the wall that it is in or at."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ...geometry.arrays import Floats
from ...scene.categories import has_category
from ...scene.graph import SceneGraph
from ..object_rows import marked_things, object_rows
from .scan import Scan
from .structure import TALLEST, Opening, Room, WallPiece
from .walls import NARROWEST

KINDS = {"Door": "door", "Window": "window"}
"""Kinds of openings by category."""

AT, DEEPEST = 0.15, 0.35
"""Metres before or behind a wall up to which something is at it, and that it is deep at most where it lies along it: a
leaf that stands open does not."""

WITHIN = 0.5
"""Share of a door's width that is along a wall, at least."""

STEP = 0.5
"""Metres over the floor up to which a door begins: others are of another storey, or of a cupboard."""


@dataclass(frozen=True, eq=False)
class NamedOpening:
    """What the user calls a door or a window: ``kind``, and its corners (P, 3) in world metres."""

    kind: str
    points: Floats

    def seen_along(self, wall: WallPiece) -> tuple[Floats, Floats]:
        """From where to where it reaches along a wall, and to the left of it, (2,) metres each."""
        along = (wall.stop - wall.start) / wall.length
        step = self.points[:, :2] - wall.start
        places = step @ along, step @ np.array([-along[1], along[0]])
        one, two = (np.array([place.min(), place.max()]) for place in places)
        return one, two


def with_named_openings(rooms: list[Room], scan: Scan, graph: SceneGraph) -> list[Room]:
    """The rooms with the openings that the user names; a hole that one of them fills is not counted again.

    A door between two rooms is one of both, as a hole is. What stands before no wall, or across it, is none.
    """
    named = list(_named(scan, graph))
    return [_with_named(room, named) for room in rooms] if named else rooms


def _named(scan: Scan, graph: SceneGraph) -> Iterator[NamedOpening]:
    """What has a category of openings, and is not marked as a thing."""
    owner, said = object_rows(graph), ~marked_things(graph)
    for category, kind in KINDS.items():
        chosen = (has_category(graph, [category])[owner] & (owner >= 0) & said)[scan.row]
        of = owner[scan.row[chosen]]
        for row in np.unique(of).tolist():
            yield NamedOpening(kind, scan.triangles[chosen][of == row].reshape(-1, 3))


def _with_named(room: Room, named: list[NamedOpening]) -> Room:
    openings = list(room.openings)
    for thing in named:
        found = _opening(thing, room)
        if found is not None:
            openings = [*(hole for hole in openings if not _same(hole, found)), found]
    return replace(room, openings=tuple(openings)) if len(named) else room


def _opening(thing: NamedOpening, room: Room) -> Opening | None:
    """What is named as an opening of the wall of a room along which most of it lies, None where it is in none."""
    bottom, top = thing.points[:, 2].min(), thing.points[:, 2].max()
    ceiling = min(room.ceiling, room.floor + TALLEST)
    if not room.floor < (bottom + top) / 2 < ceiling or (thing.kind == "door" and bottom > room.floor + STEP):
        return None
    best, found = 0.0, None
    for wall in room.walls:
        place, offset = thing.seen_along(wall)
        begin, end = place.clip(0, wall.length)
        at = offset[0] <= AT and offset[1] >= -wall.thickness - AT and np.ptp(offset) <= wall.thickness + DEEPEST
        if at and end - begin >= max(NARROWEST, WITHIN * np.ptp(place), best):
            along = (wall.stop - wall.start) / wall.length
            low = room.floor if thing.kind == "door" else max(bottom, room.floor)
            start, stop = wall.start + begin * along, wall.start + end * along
            best, found = end - begin, Opening(thing.kind, start, stop, float(low), float(min(top, ceiling)))
    return found


def _same(hole: Opening, found: Opening) -> bool:
    """Does most of a hole lie where something named is, or most of that in the hole?"""
    length = float(np.linalg.norm(found.stop - found.start))
    along = (found.stop - found.start) / length
    ends = np.stack([hole.start, hole.stop]) - found.start
    if np.abs(ends @ np.array([-along[1], along[0]])).max() > DEEPEST:
        return False
    low, high = np.sort(ends @ along)
    shared = min(high, length) - max(low, 0.0)
    high_as = min(hole.top, found.top) - max(hole.bottom, found.bottom)
    return bool(shared > WITHIN * min(high - low, length) and high_as > 0)

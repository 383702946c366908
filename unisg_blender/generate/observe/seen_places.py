"""Seen places: where the objects of training scenes stood, in several frames, so that it can be tried elsewhere."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.planar import rectangle_gap, rotate, wrapped
from .observed_scene import ObservedScene
from .prior_tables import PriorTables
from .room_walls import RoomWalls

ROOM, KIND, ON_TOP, ACROSS, ALONG, TURN, ABOVE, GAP, WALL_TURN, NEAR = range(10)
"""Columns of a seen place: number of its room; number of the support's category (-1: the ground, -2: of none that is
known); whether it stood on a surface; where on the support, in its half extents, and the turn against it, radians;
height above the support's bottom (the ground: above that); clearance to the nearest wall and turn against its normal;
then, for each of :data:`NEIGHBOURS`, its category (-1: none), its offset in that one's frame (2) and turn against it.
"""

NEIGHBOURS, PER_NEIGHBOUR = 2, 4
WIDTH = NEAR + NEIGHBOURS * PER_NEIGHBOUR
NEARBY = 2.5
"""Metres of clearance up to which something is a neighbour."""

DIGITS = 4
RAISED = 0.05
"""Metres above the ground from which on something without a support hangs."""


class SeenPlaces:
    """The places of each category, by number: (P, :data:`WIDTH`)."""

    def __init__(self, places: Mapping[int, Floats]) -> None:
        self.places = dict(places)

    @staticmethod
    def of(scenes: Sequence[ObservedScene], tables: PriorTables) -> SeenPlaces:
        """The places in some scenes, whose numbers are those of the rooms."""
        found: dict[int, list[Floats]] = {}
        for room, scene in enumerate(scenes):
            known = np.flatnonzero((scene.category >= 0) & ~tables.structural[scene.category])
            for obj, row in zip(known, _rows(scene, known, room, tables), strict=True):
                found.setdefault(int(scene.category[obj]), []).append(row)
        return SeenPlaces({category: np.array(rows).round(DIGITS) for category, rows in found.items()})

    def of_category(self, category: int) -> Floats:
        """Those of a category (P, :data:`WIDTH`)."""
        return self.places.get(category, np.zeros((0, WIDTH)))

    def without(self, room: int) -> SeenPlaces:
        """All but those of one room; of a category that is in no other room, these too."""
        kept = {category: rows[rows[:, ROOM] != room] for category, rows in self.places.items()}
        return SeenPlaces({category: rows if len(rows) else self.places[category] for category, rows in kept.items()})

    def to_record(self, vocabulary: Sequence[str]) -> dict[str, list[list[float]]]:
        """By names, JSON-ready."""
        return {vocabulary[category]: rows.tolist() for category, rows in self.places.items()}

    @staticmethod
    def from_record(record: Mapping[str, Sequence[Sequence[float]]], vocabulary: Sequence[str]) -> SeenPlaces:
        """The same read back; ValueError if it is damaged."""
        number = {name: position for position, name in enumerate(vocabulary)}
        places = {number[name]: np.array(rows, np.float64) for name, rows in record.items() if name in number}
        for rows in places.values():
            if rows.ndim != 2 or rows.shape[1] != WIDTH or (np.abs(rows[:, KIND]) > len(vocabulary)).any():
                raise ValueError("seen places have another width")
        return SeenPlaces(places)


def _rows(scene: ObservedScene, objects: Ints, room: int, tables: PriorTables) -> Floats:
    """What is kept of some objects, (K, :data:`WIDTH`)."""
    rows = np.zeros((len(objects), WIDTH))
    support, held = scene.support[objects], scene.support[objects] >= 0
    below = np.maximum(support, 0)
    bottom = scene.center[objects, 2] - scene.half[objects, 2]
    origin = np.where(held[:, None], scene.center[below], np.append(scene.room.middle, 0))
    turn = np.where(held, scene.yaw[below], 0.0)
    half = np.where(held[:, None], np.maximum(scene.half[below, :2], 1e-3), 1.0)
    rows[:, ROOM] = room
    rows[:, KIND] = np.where(held, np.where(scene.category[below] < 0, -2, scene.category[below]), -1)
    rows[:, ON_TOP] = scene.surface[objects] >= 0
    rows[:, [ACROSS, ALONG]] = rotate((scene.center[objects] - origin)[:, :2], -turn) / half
    rows[:, TURN] = wrapped(scene.yaw[objects] - turn)
    rows[:, ABOVE] = bottom - np.where(held, scene.center[below, 2] - scene.half[below, 2], scene.room.ground)
    places = np.column_stack([scene.center[objects, :2], bottom, scene.yaw[objects]])
    walls = RoomWalls.of(scene, tables)
    for row, obj in enumerate(objects):
        gap, normal = walls.gaps(places[row : row + 1], scene.half[obj])
        nearest = int(gap[0].argmin()) if gap.shape[1] else 0
        rows[row, GAP] = gap[0, nearest] if gap.shape[1] else 0.0
        rows[row, WALL_TURN] = wrapped(places[row, 3] - normal[0, nearest]) if gap.shape[1] else 0.0
        rows[row, NEAR:] = _neighbours(scene, int(obj), neighbours_of(scene, int(obj), tables))
    return rows


def neighbours_of(scene: ObservedScene, obj: int, tables: PriorTables) -> Bools:
    """What stands beside an object: on the same thing, or else on the floor or ground as well, bool (K,)."""
    structural, floors = tables.structural[scene.category], on_floors(scene, tables)
    support = int(scene.support[obj])
    mine = floors if support < 0 or structural[support] else scene.support == support
    mine = mine & ~structural & (scene.category >= 0)
    mine[obj] = False
    return mine


def on_floors(scene: ObservedScene, tables: PriorTables) -> Bools:
    """What stands on the building or on nothing, and does not hang, bool (K,)."""
    held = scene.support >= 0
    building = tables.structural[scene.category][np.maximum(scene.support, 0)]
    return np.asarray((~held | building) & (scene.center[:, 2] - scene.half[:, 2] < scene.room.ground + RAISED))


def _neighbours(scene: ObservedScene, obj: int, beside: Bools) -> Floats:
    """The nearest ones: category, offset and turn of the object as they see it."""
    found = np.tile([-1.0, 0, 0, 0], NEIGHBOURS)
    others = np.flatnonzero(beside)
    gap = rectangle_gap(
        scene.center[others, :2] - scene.center[obj, :2], scene.yaw[obj], scene.half[obj, :2], scene.yaw[others],
        scene.half[others, :2],
    )  # fmt: skip
    for place, number in enumerate(np.argsort(gap)[:NEIGHBOURS]):
        other = others[number]
        if gap[number] < NEARBY:
            offset = rotate(scene.center[obj, :2] - scene.center[other, :2], -scene.yaw[other])
            turn = wrapped(scene.yaw[obj] - scene.yaw[other])
            found[PER_NEIGHBOUR * place :][:PER_NEIGHBOUR] = scene.category[other], *offset, turn
    return found

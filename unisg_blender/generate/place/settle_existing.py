"""Where objects that a scene has come to rest: on what is below them, apart from each other, in the room."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...dataset.assets.asset import object_graph
from ...geometry.arrays import Bools, Floats
from ...geometry.boxes import covers, part_tops
from ...geometry.planar import rotate
from ...scene import SceneGraph
from ...scene.categories import FLOOR, STRUCTURE
from ...scene.structure_marks import locked_rows
from ...spatial.object_rows import object_rows
from ...spatial.objects import SceneObjects
from ...spatial.structure.room_objects import RoomObjects, room_objects
from ...spatial.supports import levels_of
from ..observe.placeable import Placeable
from ..observe.prior_tables import PriorTables
from ..observe.support_priors import AT_SIDE, HANGS, RESTS, CategoryPriors, SupportPrior, contact, side_gap
from .free_space import NOBODY, FreeSpace
from .refusal_reason import why_not
from .settle_geometry import Support, fitting, rest, search

RINGS, STEPS, DIRECTIONS = ((0.02, 0.6), (0.6, 3.0)), 16, 16
"""Free places are looked for on so many rings between such radii in metres, the nearer ones first, in so many
directions."""

OFF_WALL, OFF_FLOOR, FLAT = 0.03, 0.3, 0.25
"""Metres before a wall, and above the lowest floor, at which something hangs on it that is no deeper than such a share
of its size."""

SUNK = 0.5
"""An object may be sunk by this share of its height into what it is to stand on."""

LOCKED = "it is locked"

STANDS, DEEP = 0.02, 0.1
"""Metres between an object and what it stands on already, and how deep it is in another thing all the same if it was
pushed into that: a rug or a mattress is thinner than what one is pushed into."""


@dataclass(frozen=True, eq=False)
class Settled:
    """What became of one object: its row, its ``world`` matrix (4, 4) now, and a ``note`` if it found no place.

    ``holder`` is the row of what it hangs from or is fixed to, -1 for what stands.
    """

    row: int
    world: Floats
    note: str = ""
    holder: int = -1


def resting_places(
    graph: SceneGraph, rows: Iterable[int], near: Floats | None = None, outdoors: bool = False
) -> list[Settled]:
    """Where the objects at some rows come to stand, each moved as little as need be; nothing else is moved.

    An object is put on the highest surface below its middle, or held as it is held by what it is
    parented to if it hangs there or is fixed to its side. Objects that stand on others come after
    them. What finds no free place stays where it is, with a note. Structure is left alone. The room is the one that the
    point ``near`` (3,) is in, or the largest; ``outdoors`` nothing is kept in a room.
    """
    room = room_objects(graph, graph.vocabulary, near)
    objects = room.objects
    names = [
        FLOOR if floor else graph.category_name(int(row)) for row, floor in zip(objects.row, room.floor, strict=True)
    ]
    walls = [number for number, name in enumerate(names) if name == "Wall" or _is_made_wall(room, number)]
    wanted, filled = set(rows), np.unique(objects.owner)
    mine = [int(t) for t in filled if int(objects.row[t]) in wanted and not _is_building(room, names, int(t))]
    kept = kept_by_locks(graph, objects, mine)
    mine = [t for t in mine if t not in kept]
    fixed = np.isin(objects.owner, [t for own in mine for t in (own, *held_by(objects, own))], invert=True)
    unknown = np.full(len(objects), -1, np.int64)
    space = FreeSpace(
        objects.parts.take(np.flatnonzero(fixed)), objects.owner[fixed], unknown,
        None if outdoors else room.outline,
        PriorTables.of(CategoryPriors({}, {}, {}, []), ())
    )  # fmt: skip
    space.take_up(room.obstacles, NOBODY)
    found = [Settled(int(objects.row[t]), graph.world[objects.row[t]], note) for t, note in kept.items()]
    level = levels_of(objects.support)
    for obj in sorted(mine, key=lambda t: (level[t], t)):
        row = int(objects.row[obj])
        placeable = Placeable(object_graph(graph, row))
        now = np.array([*objects.center[obj, :2], objects.bottom[obj], objects.yaw[obj]])
        supports = _supports_of(objects, obj, names, walls, space)
        places = ((_settled(placeable, now, each, space), each) for each in supports)
        place, support = next((pair for pair in places if pair[0] is not None), (None, supports[0]))
        name = names[support.obj] if support.obj >= 0 else ""
        note = "" if place is not None else why_not(placeable, now, -1, support, name, space)
        held = held_by(objects, obj)
        if place is not None:
            objects = _moved(objects, [obj, *held], now, place)
        space.take_up(objects.parts_of(obj), obj)
        for other in held:
            if other not in mine:
                space.take_up(objects.parts_of(other), other)
        here, hangs = now if place is None else place, support.contact in (HANGS, AT_SIDE)
        found.append(Settled(row, placeable.world(here), note, int(objects.row[support.obj]) if hangs else -1))
    return found


def kept_by_locks(graph: SceneGraph, objects: SceneObjects, wanted: Iterable[int]) -> dict[int, str]:
    """Of some objects, by number, those that stay where they are, and why: they are locked, or something on them is."""
    owner, of_row = object_rows(graph), {int(row): number for number, row in enumerate(objects.row)}
    locked = {of_row.get(int(owner[row]), -1) for row in locked_rows(graph)}
    found = {}
    for obj in wanted if locked else ():
        on_it = [other for other in held_by(objects, obj) if other in locked]
        if obj in locked:
            found[obj] = LOCKED
        elif on_it:
            found[obj] = f"{graph.name[int(objects.row[on_it[0]])]} on it is locked"
    return found


def _is_made_wall(room: RoomObjects, obj: int) -> bool:
    """Is an object a wall that was recognised? Openings are in walls, walls on the floor."""
    made = room.structure is not None and int(room.objects.row[obj]) in room.structure.parts
    return made and not room.floor[obj] and room.objects.relation[obj] == "on_top_of"


def _is_building(room: RoomObjects, names: Sequence[str], obj: int) -> bool:
    return names[obj] in STRUCTURE or (
        room.structure is not None and int(room.objects.row[obj]) in room.structure.parts
    )


def held_by(objects: SceneObjects, obj: int) -> list[int]:
    """All that stands on an object, and on that, which moves along."""
    found = {obj}
    for other in np.argsort(levels_of(objects.support), kind="stable"):
        if int(objects.support[other]) in found:
            found.add(int(other))
    return sorted(found - {obj})


def _moved(objects: SceneObjects, moving: Iterable[int], before: Floats, after: Floats) -> SceneObjects:
    """The objects with some of them moved as one from a place (4,) to another."""
    chosen = np.isin(np.arange(len(objects)), list(moving))
    spin = after[3] - before[3]

    def carried(points: Floats, which: Bools) -> Floats:
        """Points (K, 3), those of ``which`` (K,) moved and turned with the object, metres."""
        return np.where(which[:, None], rotate(points - before[:3], spin) + after[:3], points)

    of_parts = chosen[objects.owner]
    axes = np.swapaxes(rotate(np.swapaxes(objects.parts.axes, 1, 2), spin), 1, 2)
    parts = replace(
        objects.parts, center=carried(objects.parts.center, of_parts),
        axes=np.where(of_parts[:, None, None], axes, objects.parts.axes),
    )  # fmt: skip
    return replace(objects, center=carried(objects.center, chosen), yaw=objects.yaw + spin * chosen, parts=parts)


def _supports_of(
    objects: SceneObjects, obj: int, names: list[str], walls: Sequence[int], space: FreeSpace
) -> list[Support]:
    """What may hold an object, the best first: what it hangs from or is fixed to, else what is below its middle.

    Where that has no room for it, it is what is below that. What stands on something already, deep in another thing,
    stays on it: a chair that was pushed into a sofa is to stand before it, not on its seat.
    """
    parent = int(objects.support[obj])
    if parent >= 0:
        kind, gap = contact(objects, obj, parent)
        if kind in (HANGS, AT_SIDE) and names[parent] != FLOOR:
            return [Support(parent, SupportPrior(names[parent], 1, kind, gap), space.parts_of(parent), False)]
    wall, gap = _wall_behind(objects, obj, walls)
    if wall >= 0:
        return [Support(wall, SupportPrior("Wall", 1, AT_SIDE, gap), space.parts_of(wall), False)]
    tops = np.where(space.owner == NOBODY, np.inf, part_tops(space.boxes))
    bottom = objects.bottom[obj]
    under = covers(space.boxes, objects.center[obj, :2]) & (tops <= bottom + SUNK * 2 * objects.half[obj, 2] + 1e-6)
    if not under.any():
        return [Support(-1, SupportPrior("", 1, RESTS), space.boxes.take(np.zeros(0, np.int64)), False)]
    downwards = under.nonzero()[0][np.argsort(-tops[under], kind="stable")]
    below = list(dict.fromkeys(space.owner[downwards].tolist()))  # the highest top of each counts
    height = {owner: float(tops[under & (space.owner == owner)].max()) for owner in below}
    if height[below[0]] > bottom + DEEP:
        below.sort(key=lambda owner: abs(height[owner] - bottom) > STANDS)
    return [
        Support(owner, SupportPrior(names[owner], 1, RESTS), space.parts_of(owner), names[owner] == FLOOR)
        for owner in below
    ]


def _wall_behind(objects: SceneObjects, obj: int, walls: Sequence[int]) -> tuple[int, float]:
    """The wall that something flat hangs on, or close before, off the floor, and the gap, metres; -1 for none."""
    half = objects.half[obj]
    if min(half[:2]) > FLAT * max(half) or objects.bottom[obj] - objects.bottom.min() < OFF_FLOOR:
        return -1, 0.0
    found = []
    for wall in walls:
        if objects.bottom[wall] < objects.center[obj, 2] < objects.top[wall]:
            gap = side_gap(objects, obj, wall)
            if -OFF_WALL <= gap <= OFF_WALL:
                found.append((abs(gap), wall, max(gap, 0.0)))
    return min(found)[1:] if found else (-1, 0.0)


def _settled(placeable: Placeable, now: Floats, support: Support, space: FreeSpace) -> Floats | None:
    """The nearest free place (4,), None if there is none; as it is if it is settled already."""
    place = rest(placeable, now[None], support, space)
    if fitting(placeable, place, -1, support, space)[0]:
        return place[0]
    turns = np.linspace(0, 2 * np.pi, DIRECTIONS, endpoint=False)
    for radii in RINGS:
        places = np.repeat(now[None], STEPS * DIRECTIONS, axis=0)
        places[:, :2] += np.concatenate([rotate(np.array([step, 0.0]), turns) for step in np.linspace(*radii, STEPS)])
        places = rest(placeable, places, support, space)
        free = np.flatnonzero(fitting(placeable, places, -1, support, space))
        if len(free):
            return places[free[((places[free, :3] - now[:3]) ** 2).sum(axis=1).argmin()]]
    return search(placeable, now, -1, support, space)

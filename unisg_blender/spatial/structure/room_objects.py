"""A room as a generator sees it, whoever made it: floor, walls and openings as objects, and what is in the way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...geometry.arrays import Bools, Floats
from ...geometry.boxes import Boxes, world_bounds
from ...geometry.corner_ends import corner_ends
from ...geometry.planar import rotation
from ...geometry.polygon import inside, least_rectangle
from ...scene.categories import FLOOR, STRUCTURE
from ...scene.graph import SceneGraph
from ...scene.hierarchy import world_matrices
from ..floor_plan import room_outline
from ..object_rows import marked_things
from ..objects import SceneObjects, scene_objects
from .hollow_parts import with_faces
from .recognise import recognise_structure
from .scan import world_triangles
from .structure import HoldingSurface, Opening, Room, Structure, WallPiece
from .triangle_boxes import triangle_boxes

INTRUDES, HIGH, LONG = 0.2, 1.8, 2.0
"""Square metres of a room that the box of a wall may cover: where it covers more, the box is not the wall. What has no
category counts as a wall if it is so high and long, metres, that it may be a building."""

SLAB, SHEET, THICKEST = 0.1, 0.1, 0.28
"""Metres: a floor's thickness, that of a one-sided wall, and that of a wall at most."""

BOARD, FILLED = 0.02, 0.7
"""Metres of thickness of a built-in surface, and the share of the rectangle around it that it fills at least."""

ON_FLOOR = 0.1
"""Metres above or below a floor at which something stands on it."""

OVER_FLOOR = 0.03
"""Metres over the floor from which on faces of the building are in the way."""


@dataclass(frozen=True, eq=False)
class RoomObjects:
    """K objects of a scene with the room that they are in.

    Attributes
    ----------
    objects
        The objects. Where the structure had to be recognised, what is building stands for itself no more: floor, walls,
        doors and windows are objects in its place, with the rows of the entities that they are part of.
    world
        Matrices (K, 4, 4) of the objects in the world.
    floor
        bool (K,): which are floors.
    outline
        Outline (M, 2) of the room in world metres; None if there is none.
    obstacles
        Boxes over the faces of what the building is made of; none where its objects' boxes say as much.
    structure
        What was recognised; None where the scene's own categories tell the room.
    """

    objects: SceneObjects
    world: Floats
    floor: Bools
    outline: Floats | None
    obstacles: Boxes
    structure: Structure | None = None


def room_objects(
    graph: SceneGraph, vocabulary: Sequence[str], near: Floats | None = None, alone: bool = False
) -> RoomObjects:
    """The objects of a scene, categories numbered as in ``vocabulary``, and its room.

    A scene whose floor has its category, and whose walls have boxes that leave the room free, is taken as it is. In
    any other the structure is recognised, and the room is the one that the point ``near`` (3,) is in, or the largest.
    With ``alone`` it is recognised anyway, and what is in other rooms is left out.
    """
    objects = scene_objects(graph, vocabulary)
    names = [graph.category_name(int(row)) for row in objects.row]
    floor = np.array([name == FLOOR for name in names], bool)
    solid = np.isin(np.arange(len(objects)), objects.owner)
    outline = room_outline(graph) if (floor & solid).any() else None
    world = world_matrices(graph)[objects.row]
    plain = RoomObjects(objects, world, floor, outline, objects.parts.take(np.zeros(0, np.int64)))
    things = marked_things(graph)[objects.row]
    clear = outline is not None and not alone and not _in_the_way(objects, names, things, outline)
    if not solid.any() or clear:
        return plain
    structure = recognise_structure(graph)
    if not structure.rooms:
        return plain
    number = structure.room_at(near) if near is not None else -1
    room = structure.rooms[number] if number >= 0 else max(structure.rooms, key=lambda room: (room.indoors, room.area))
    elsewhere = np.array([alone and structure.room_at(middle) not in (number, -1) for middle in objects.center], bool)
    return _rebuilt(graph, vocabulary, objects, names, structure, room, elsewhere)


def _in_the_way(objects: SceneObjects, names: Sequence[str], things: Bools, outline: Floats) -> bool:
    """Does the box of a wall, or of what may be a building and is not marked as one of ``things``, cover the room?"""
    low, high = world_bounds(objects.parts)
    size = high - low
    built = np.array([name in STRUCTURE and name != FLOOR for name in names], bool)[objects.owner]
    nameless = (np.array([not name for name in names], bool) & ~things)[objects.owner]
    built |= nameless & (size[:, 2] >= HIGH) & (size[:, :2].max(axis=1) >= LONG) & (size[:, :2].min(axis=1) > SHEET)
    steps = (np.arange(12) + 0.5) / 12
    grid = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    for part in np.flatnonzero(built & (size[:, 2] > ON_FLOOR)).tolist():
        box = objects.parts.take(np.array([part]))
        flat = np.abs(box.axes[0, 2]).argmax()
        one, two = (axis for axis in range(3) if axis != flat)
        places = box.center[0, :2] + (2 * grid[:, :1] - 1) * box.half[0, one] * box.axes[0, :2, one]
        places = places + (2 * grid[:, 1:] - 1) * box.half[0, two] * box.axes[0, :2, two]
        if inside(outline, places).mean() * 4 * box.half[0, one] * box.half[0, two] > INTRUDES:
            return True
    return False


@dataclass(eq=False)
class _Made:
    """Objects that are being made for parts of a building."""

    rows: list[int]
    names: list[str]
    support: list[int]
    center: list[Floats]
    half: list[Floats]
    yaw: list[float]
    relation: list[str]

    def add(self, row: int, name: str, support: int, center: Floats, half: Floats, yaw: float, relation: str) -> int:
        """One more; returns its number."""
        for column, value in zip(vars(self).values(), (row, name, support, center, half, yaw, relation), strict=True):
            column.append(value)
        return len(self.rows) - 1


def _rebuilt(
    graph: SceneGraph, vocabulary: Sequence[str], objects: SceneObjects, names: Sequence[str], structure: Structure,
    room: Room, elsewhere: Bools,
) -> RoomObjects:  # fmt: skip
    """The objects with what is building replaced by the room's floor, walls and openings, which come first.

    What is ``elsewhere`` (K,) is left out.
    """
    free = np.array([not name or name in STRUCTURE for name in names], bool)
    building = np.isin(names, [FLOOR, "Wall", "Ceiling"]) | (free & np.isin(objects.row, list(structure.parts)))
    made = _parts_of_room(room, named={"Door", "Window"} & set(names))
    built_in = [top for top in structure.surfaces if structure.rooms[top.room] is room]
    _add_built_in(made, [top for top in built_in if top.row in objects.row[building]])
    kept = np.flatnonzero(~building & ~elsewhere)
    numbers = np.full(len(objects) + 1, -1, np.int64)
    numbers[kept] = len(made.rows) + np.arange(len(kept))
    support = numbers[objects.support[kept]]
    for place, obj in enumerate(kept.tolist()):
        if support[place] < 0:
            support[place] = _held_by_room(objects, obj, made, room)
    count = len(made.rows)
    turns = rotation(np.array(made.yaw))
    parts, part_owner = with_faces(graph, objects, ~building)
    boxes = Boxes(
        np.concatenate([made.center, parts.center]), np.concatenate([turns, parts.axes]),
        np.concatenate([made.half, parts.half]), np.ones(count + len(part_owner), bool),
    )  # fmt: skip
    owner = np.concatenate([np.arange(count), numbers[part_owner]])
    chosen = owner >= 0
    known = {name: number for number, name in enumerate(vocabulary)}
    category = np.array([known.get(name, -1) for name in made.names], np.int64)
    found = SceneObjects(
        np.concatenate([np.array(made.rows, np.int64), objects.row[kept]]),
        np.concatenate([category, objects.category[kept]]),
        np.concatenate([np.array(made.support, np.int64), support]),
        np.concatenate([made.center, objects.center[kept]]), np.concatenate([made.half, objects.half[kept]]),
        np.concatenate([made.yaw, objects.yaw[kept]]), boxes.take(np.flatnonzero(chosen)), owner[chosen],
        (*made.relation, *(objects.relation[obj] for obj in kept)),
    )  # fmt: skip
    own = np.tile(np.eye(4), (count, 1, 1))
    own[:, :3, :3], own[:, :3, 3] = turns, np.array(made.center)
    world = np.concatenate([own, world_matrices(graph)[objects.row[kept]]])
    floor = np.arange(len(found)) == 0
    return RoomObjects(found, world, floor, room.outline, _obstacles(graph, objects, building, room), structure)


def _add_built_in(made: _Made, surfaces: Sequence[HoldingSurface]) -> None:
    """Counters and shelves that are part of the building's meshes: what they are is not known, but they hold things."""
    for surface in surfaces:
        middle, half, yaw = least_rectangle(surface.outline)
        if surface.area >= FILLED * 4 * half.prod():
            center = np.array([*middle, surface.height - BOARD / 2])
            made.add(surface.row, "", 0, center, np.array([*half, BOARD / 2]), yaw, "")


def _parts_of_room(room: Room, named: set[str]) -> _Made:
    """Floor, walls and openings of a room as objects; openings of a kind that the user ``named`` are there already."""
    made = _Made([], [], [], [], [], [], [])
    low, high = room.outline.min(axis=0), room.outline.max(axis=0)
    middle = np.array([*(low + high) / 2, room.floor - SLAB / 2])
    made.add(room.floor_row, FLOOR, -1, middle, np.array([*(high - low) / 2, SLAB / 2]), 0.0, "")
    for wall in room.walls:
        thickness = min(wall.thickness or SHEET, THICKEST)
        number = made.add(*_upright(wall.row if wall.row >= 0 else room.floor_row, "Wall", 0, wall, thickness))
        for opening in room.openings:
            kind = {"door": "Door", "window": "Window"}.get(opening.kind, "")
            if kind and kind not in named and _is_in(opening, wall):
                piece = WallPiece(opening.start, opening.stop, wall.thickness, opening.bottom, opening.top, wall.row)
                made.add(*_upright(made.rows[number], kind, number, piece, thickness))
    return made


def _upright(
    row: int, name: str, support: int, wall: WallPiece, thickness: float
) -> tuple[int, str, int, Floats, Floats, float, str]:
    """A wall or an opening as an object: long along x, y looks out of the room."""
    along = (wall.stop - wall.start) / wall.length
    out = np.array([along[1], -along[0]])
    center = np.array([*(wall.start + wall.stop) / 2 + out * thickness / 2, (wall.bottom + wall.top) / 2])
    half = np.array([wall.length / 2, thickness / 2, (wall.top - wall.bottom) / 2])
    relation = "on_top_of" if support == 0 else "inside"
    return row, name, support, center, half, float(np.arctan2(-out[0], out[1])), relation


def _is_in(opening: Opening, wall: WallPiece) -> bool:
    along = (wall.stop - wall.start) / wall.length
    step = (opening.start + opening.stop) / 2 - wall.start
    return bool(abs(step[0] * along[1] - step[1] * along[0]) < 1e-3 and 0 <= step @ along <= wall.length)


def _held_by_room(objects: SceneObjects, obj: int, made: _Made, room: Room) -> int:
    """The floor for what stands on it, the nearest wall for what hung on one, -1 for the rest."""
    if abs(objects.bottom[obj] - room.floor) <= ON_FLOOR and room.contains(objects.center[obj, :2]):
        return 0
    if objects.relation[obj] not in ("hangs_from", "inside"):
        return -1
    walls = [number for number, name in enumerate(made.names) if name == "Wall"]
    away = [
        np.linalg.norm(made.center[number][:2] - objects.center[obj, :2]) - made.half[number][0] for number in walls
    ]
    return walls[int(np.argmin(away))] if walls else -1


def _obstacles(graph: SceneGraph, objects: SceneObjects, building: Bools, room: Room) -> Boxes:
    """Flat boxes over the faces of the building that are in a room, over its floor."""
    triangles, row = world_triangles(graph)
    low, high = corner_ends(triangles)
    top = min(room.ceiling - OVER_FLOOR, room.floor + HIGH + LONG)
    mine = np.isin(row, objects.row[building]) & (high[:, 2] > room.floor + OVER_FLOOR) & (low[:, 2] < top)
    around = room.outline.min(axis=0), room.outline.max(axis=0)
    mine &= (high[:, :2] >= around[0]).all(axis=1) & (low[:, :2] <= around[1]).all(axis=1)
    return triangle_boxes(triangles[mine])

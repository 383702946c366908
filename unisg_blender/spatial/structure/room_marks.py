"""What users say of rooms: which kind each is, and what is none."""

from __future__ import annotations

from dataclasses import replace

from ...scene.graph import SceneGraph
from ...scene.structure_marks import NO_ROOM, ROOM_MARK, marks
from ..objects import middle_of
from .structure import Structure


def marked_rooms(structure: Structure, graph: SceneGraph) -> dict[int, str]:
    """What is said of rooms, by their numbers: marks of what is the floor of one room only, or else is in a room."""
    said = marks(graph, ROOM_MARK)
    return {number: said[row] for row, number in marked_by(structure, graph).items()}


def marked_by(structure: Structure, graph: SceneGraph) -> dict[int, int]:
    """By row of what has a mark of rooms the number of the room that it is about."""
    found = {}
    for row in marks(graph, ROOM_MARK):
        floor_of = [number for number, room in enumerate(structure.rooms) if room.floor_row == row]
        middle = middle_of(graph, graph.uid[row])
        number = floor_of[0] if len(floor_of) == 1 else structure.room_at(middle) if middle is not None else -1
        if number >= 0:
            found[row] = number
    return found


def without_marked(structure: Structure, graph: SceneGraph) -> Structure:
    """The structure without what users say is no room, and without the surfaces in there."""
    gone = {number for number, kind in marked_rooms(structure, graph).items() if kind == NO_ROOM}
    if not gone:
        return structure
    kept = [number for number in range(len(structure.rooms)) if number not in gone]
    place = {number: order for order, number in enumerate(kept)}
    return replace(
        structure,
        rooms=tuple(structure.rooms[number] for number in kept),
        surfaces=tuple(
            replace(surface, room=place[surface.room]) for surface in structure.surfaces if surface.room in place
        ),
    )

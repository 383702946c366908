"""Structure as lines for people and as records for programs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from ...scene.graph import SceneGraph
from .room_things import RoomName, things_in_rooms
from .structure import Room, Structure

DIGITS = 4

FEW = 5
"""Things of a room that are named in a line, at most."""


def structure_record(
    structure: Structure, graph: SceneGraph, names: Sequence[RoomName] | None = None
) -> dict[str, Any]:
    """JSON-ready: rooms with what they are, if that is known, surfaces, parts by name, notes; lengths in metres."""
    names = names or [RoomName()] * len(structure.rooms)
    return {
        "storeys": structure.storeys,
        "rooms": [
            {"kind": name.kind or None, "why": name.why or None, "also": list(name.also)}
            | _room_record(room, graph)
            | {"things": [graph.name[row] for row in rows]}
            for name, room, rows in zip(names, structure.rooms, things_in_rooms(structure, graph), strict=True)
        ],
        "surfaces": [
            {
                "object": graph.name[surface.row], "room": surface.room, "height": _number(surface.height),
                "headroom": _number(surface.headroom), "area": _number(surface.area),
                "outline": surface.outline.round(DIGITS).tolist(),
            }
            for surface in structure.surfaces
        ],
        "parts": {graph.name[row]: list(kinds) for row, kinds in structure.parts.items()},
        "cell": _number(structure.cell),
        "notes": list(structure.notes),
    }  # fmt: skip


def _room_record(room: Room, graph: SceneGraph) -> dict[str, Any]:
    def name(row: int) -> str | None:
        """The name of a row's entity."""
        return graph.name[row] if row >= 0 else None

    return {
        "storey": room.storey, "indoors": room.indoors, "area": _number(room.area), "floor": _number(room.floor),
        "ceiling": _number(room.ceiling), "outline": room.outline.round(DIGITS).tolist(),
        "holes": [hole.round(DIGITS).tolist() for hole in room.holes], "floor_object": name(room.floor_row),
        "ceiling_object": name(room.ceiling_row),
        "walls": [
            {
                "start": wall.start.round(DIGITS).tolist(), "stop": wall.stop.round(DIGITS).tolist(),
                "thickness": _number(wall.thickness), "top": _number(wall.top), "object": name(wall.row),
            }
            for wall in room.walls
        ],
        "openings": [
            {
                "kind": opening.kind, "start": opening.start.round(DIGITS).tolist(),
                "stop": opening.stop.round(DIGITS).tolist(), "bottom": _number(opening.bottom),
                "top": _number(opening.top),
            }
            for opening in room.openings
        ],
    }  # fmt: skip


def _number(value: float) -> float | None:
    return round(value, DIGITS) if np.isfinite(value) else None


def structure_lines(structure: Structure, graph: SceneGraph, names: Sequence[RoomName] | None = None) -> list[str]:
    """A line for each room, with what it is if that is known; what its parts are; and the notes."""
    if not structure.rooms:
        return list(structure.notes)
    lines = [f"{count_text(structure)} on {_many(structure.storeys, 'storey')}"]
    things = things_in_rooms(structure, graph)
    for number, room in enumerate(structure.rooms):
        kind = "room" if room.indoors else "open place"
        if names and names[number].kind:
            kind = f"{names[number].label} ({names[number].why})"
        height = f", {room.ceiling - room.floor:.2f} m high" if np.isfinite(room.ceiling) else ", no ceiling"
        told = [_many(len(room.walls), "wall")]
        told += [_many(count, kind) for kind, count in sorted(Counter(hole.kind for hole in room.openings).items())]
        held = [surface for surface in structure.surfaces if surface.room == number]
        told.append(f"{_many(len(held), 'surface')} for things")
        if things[number]:
            named = ", ".join(graph.name[row] for row in things[number][:FEW])
            more = len(things[number]) - FEW
            told.append(f"with {named}" + (f" and {more} more" if more > 0 else ""))
        lines.append(
            f"  {number}: {kind} of {room.area:.1f} m2, storey {room.storey}, floor at {room.floor:.2f} m{height}; "
            + ", ".join(told)
        )
    lines += [f"  {graph.name[row]}: {', '.join(kinds)}" for row, kinds in structure.parts.items()]
    return [*lines, *structure.notes]


def count_text(structure: Structure) -> str:
    """How many rooms there are indoors, and how many open places: "2 rooms, 1 open place"."""
    rooms = sum(room.indoors for room in structure.rooms)
    places = len(structure.rooms) - rooms
    told = [_many(rooms, "room") if rooms else "no room"]
    return ", ".join(told + ([_many(places, "open place")] if places else []))


def _many(count: int, word: str) -> str:
    return f"{count} {word}{'' if count == 1 else 's'}"

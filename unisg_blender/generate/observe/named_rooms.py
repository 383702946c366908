"""Which kind each room of a scene is: as the user says, as it is called, or by the things in it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

import numpy as np

from ...errors import UniSGError, did_you_mean
from ...geometry.arrays import Floats
from ...scene import SceneGraph
from ...scene.components import COLLECTIONS
from ...spatial.structure import Structure, recognise_structure
from ...spatial.structure.room_marks import marked_rooms
from ...spatial.structure.room_things import RoomName, things_in_rooms
from ...words import understand
from ...words.room_kinds import kind_in_name, room_table, said_kind, told_by

MOST = 0.5
"""Share of the things of a room whose collection or group is called after a kind of rooms, at least."""

SHOWN = 3


def room_names(structure: Structure, graph: SceneGraph) -> tuple[RoomName, ...]:
    """What each room is: the user's mark counts first, then the name of its floor, then what its things say."""
    if not structure.rooms:
        return ()
    things = {item.row: item.match.thing for item in understand(graph, ()).understood}
    marked, groups = marked_rooms(structure, graph), _groups(graph)
    floors = Counter(room.floor_row for room in structure.rooms)
    found = []
    for number, rows in enumerate(things_in_rooms(structure, graph)):
        floor = structure.rooms[number].floor_row
        called = graph.name[floor] if floor >= 0 and floors[floor] == 1 else ""
        if number in marked:
            found.append(RoomName(said_kind(marked[number]), "as marked"))
        elif kind := kind_in_name(called):
            found.append(RoomName(kind, f"its floor is called {called}"))
        elif kind := _of_groups(rows, groups):
            found.append(RoomName(kind, "its things are grouped so"))
        else:
            found.append(_told_name(things.get(row) or graph.category_name(row) for row in rows))
    return tuple(found)


def find_room(graph: SceneGraph, text: str) -> int:
    """The number of the room of a scene that is meant: by its number, or by what it is ("the kitchen", "Küche").

    Raises
    ------
    UniSGError
        If there is none, or there are several.
    """
    structure = recognise_structure(graph)
    names = room_names(structure, graph)
    if text.strip().isdecimal() and int(text) < len(names):
        return int(text)
    wanted = said_kind(text)
    found = [number for number, name in enumerate(names) if wanted and name.kind == wanted]
    found = found or [number for number, name in enumerate(names) if wanted in name.also]
    if len(found) == 1:
        return found[0]
    there = "; ".join(_told(number, structure, graph, names) for number in found or range(len(names)))
    if not names:
        raise UniSGError(f"no room was found in the scene, so none is {text!r}: " + " ".join(structure.notes))
    if not found:
        hint = did_you_mean(wanted, list(room_table().things)) if wanted not in room_table().things else ""
        raise UniSGError(f"no room of the scene is {text!r}{hint}: there is {there}; give a number, or mark the room")
    raise UniSGError(f"{len(found)} rooms are {text!r}: {there}; give the number of one")


def point_in_room(graph: SceneGraph, text: str) -> Floats | None:
    """A point (3,) in the room that is meant, see :func:`find_room`; None where the scene has that one only."""
    number = find_room(graph, text)
    rooms = recognise_structure(graph).rooms
    return np.append(rooms[number].inner_point, rooms[number].floor) if len(rooms) > 1 else None


def _told(number: int, structure: Structure, graph: SceneGraph, names: Sequence[RoomName]) -> str:
    """A room in a few words."""
    things = [graph.name[row] for row in things_in_rooms(structure, graph)[number][:SHOWN]]
    with_them = f" with {_listed(things)}" if things else ""
    return f"{number}: {names[number].label or 'a room'} of {structure.rooms[number].area:.1f} m2{with_them}"


def _told_name(things: Iterable[str]) -> RoomName:
    """What the things in a room say."""
    kinds = told_by(things)
    if not kinds:
        return RoomName()
    kind, *also = kinds
    return RoomName(kind, f"by its {_listed(list(dict.fromkeys(sum(kinds.values(), ()))))}", tuple(also))


def _of_groups(rows: Sequence[int], groups: Sequence[frozenset[str]]) -> str:
    """The kind of room that the groups of most things in a room are called after, "" for none."""
    votes = Counter(kind for row in rows for kind in groups[row])
    kind, many = votes.most_common(1)[0] if votes else ("", 0)
    return kind if many > MOST * len(rows) else ""


def _groups(graph: SceneGraph) -> list[frozenset[str]]:
    """For each row the kinds of rooms that its collections, and the entities above it that have no mesh, speak of."""
    listed: dict[int, set[str]] = {}
    for row, path in graph.entries(COLLECTIONS, "path"):
        listed.setdefault(row, set()).update(filter(None, map(kind_in_name, path)))
    found: list[frozenset[str]] = []
    for row, parent in enumerate(graph.parent.tolist()):  # parents come first
        above = found[parent] if parent >= 0 else frozenset()
        if parent >= 0 and graph.mesh[parent] < 0:
            above |= set(filter(None, [kind_in_name(graph.name[parent])]))
        found.append(above | listed.get(row, set()))
    return found


def _listed(names: Sequence[str]) -> str:
    """Names with commas, "and" before the last."""
    return " and ".join(filter(None, [", ".join(names[:-1]), *names[-1:]]))

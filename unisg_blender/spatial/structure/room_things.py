"""Which things are in which room, and what each room is."""

from __future__ import annotations

from dataclasses import dataclass

from ...scene.graph import SceneGraph
from ..objects import scene_objects
from .structure import Structure


@dataclass(frozen=True)
class RoomName:
    """Which ``kind`` of room one is ("kitchen"), "" where nothing tells, ``why``, in words, and what it is ``also``."""

    kind: str = ""
    why: str = ""
    also: tuple[str, ...] = ()

    @property
    def label(self) -> str:
        """All that it is: "living room and kitchen"."""
        return " and ".join(filter(None, (self.kind, *self.also)))


def things_in_rooms(structure: Structure, graph: SceneGraph) -> tuple[tuple[int, ...], ...]:
    """The rows of the objects in each room, by what their middle is over, the largest first; the building is none."""
    objects = scene_objects(graph, ())
    size = objects.half.prod(axis=1)
    found: list[list[int]] = [[] for _ in structure.rooms]
    for number in (-size).argsort(kind="stable").tolist():
        row = int(objects.row[number])
        room = structure.room_at(objects.center[number])
        if room >= 0 and row not in structure.parts:
            found[room].append(row)
    return tuple(tuple(rows) for rows in found)

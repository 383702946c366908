"""What is recognised is told by the names of rows, also of the first, and by nobody's where there is none."""

from __future__ import annotations

import numpy as np

from unisg_blender.scene import SceneBuilder
from unisg_blender.spatial.structure.structure import Room, Structure
from unisg_blender.spatial.structure.structure_text import structure_record

SQUARE = np.array([[0, 0], [4, 0], [4, 3], [0, 3]], float)


def test_floors_and_ceilings_are_named() -> None:
    builder = SceneBuilder("flat")
    for name in ("Board", "Lid"):
        builder.add(name, uid=name)
    graph = builder.build()
    rooms = tuple(
        Room(SQUARE, (SQUARE[::-1] / 4 + 1,), 0.0, ceiling, 0, True, floor, above)
        for ceiling, floor, above in ((2.5, 0, 1), (np.inf, 1, -1), (2.5, -1, 0))
    )
    told = structure_record(Structure(rooms, (), 0.05, ("a note",)), graph)
    found = [(room["floor_object"], room["ceiling_object"], room["ceiling"]) for room in told["rooms"]]
    assert found == [("Board", "Lid", 2.5), ("Lid", None, None), (None, "Board", 2.5)]
    assert told["rooms"][0]["area"] == 12 - 12 / 16
    assert told["rooms"][0]["outline"] == SQUARE.tolist()
    assert told["notes"] == ["a note"]

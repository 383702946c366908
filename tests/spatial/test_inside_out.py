"""Faces that look the wrong way: solids drawn inside out are solids, rooms drawn from inside are rooms."""

from __future__ import annotations

import numpy as np
import pytest

from unisg_blender.spatial.structure import recognise_structure

from .built_rooms import DOOR, SQUARE, box, overlap, room, scene, slab, table


def turned(part):
    points, faces = part
    return points, [face[::-1] for face in faces]


@pytest.mark.parametrize("some", ["all", "ground", "side"])
def test_solids_drawn_inside_out(some) -> None:
    parts = room(SQUARE, 0.2, roof=True, holes=(DOOR,)) | {"table": table(1.5, 1.5, 0)}
    wrong = {name: turned(part) if some == "all" or name.startswith(some) else part for name, part in parts.items()}
    structure = recognise_structure(scene(wrong))
    assert [found.indoors for found in structure.rooms] == [True]
    assert structure.rooms[0].floor == pytest.approx(0.0, abs=1e-4)
    assert overlap((structure.rooms[0].outline,), (SQUARE,)) >= 0.985


def test_a_room_drawn_from_inside_is_no_solid() -> None:
    structure = recognise_structure(scene({"room": turned(box((0, 0, 0), (5, 4, 2.5)))}))
    assert [(found.indoors, found.floor) for found in structure.rooms] == [(True, 0.0)]
    assert np.isclose(structure.rooms[0].area, 20.0, rtol=0.02)


def test_a_slab_drawn_inside_out_is_walked_on_not_in() -> None:
    parts = room(SQUARE, 0.1, height=4.4) | {"between": turned(slab(SQUARE, 2.0, 2.2))}
    structure = recognise_structure(scene(parts))
    assert sorted(round(found.floor, 3) for found in structure.rooms) == [0.0, 2.2]

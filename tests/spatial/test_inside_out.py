"""Faces that look the wrong way: solids drawn inside out are solids, rooms drawn from inside are rooms."""

from __future__ import annotations

import numpy as np
import pytest

from unisg_blender.spatial.structure import recognise_structure

from .built_rooms import DOOR, SQUARE, box, joined, overlap, room, scene, slab, table


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


@pytest.mark.parametrize("sunk", [0.0, 0.03, 0.4])
def test_a_block_that_is_sunk_in_the_ground_is_no_room(sunk: float) -> None:
    ground = slab(np.array([[-6, -6], [6, -6], [6, 6], [-6, 6]], float), -0.5, 0.0)
    structure = recognise_structure(scene({"ground": ground, "block": box((-1, -1, -sunk), (1, 1, 2.1))}))
    assert [(found.indoors, found.floor) for found in structure.rooms] == [(False, 0.0)]


def test_what_only_reaches_into_a_block_does_not_make_a_room_of_it() -> None:
    ground = slab(np.array([[-6, -6], [6, -6], [6, 6], [-6, 6]], float), -0.5, 0.0)
    beam = joined([box((-4, 0, 1), (-0.5, 0.2, 1.2)), box((-4, 0, 1.5), (-3, 0.2, 1.7))])
    parts = {"ground": ground, "block": box((-1, -1, -0.03), (1, 1, 2.1)), "beam": beam}
    assert not any(found.indoors for found in recognise_structure(scene(parts)).rooms)


def test_a_cellar_in_a_block_of_land_is_a_room() -> None:
    land = slab(np.array([[-9, -9], [9, -9], [9, 9], [-9, 9]], float), -4.0, 0.0)
    cellar = {name: (points - (0, 0, 3), faces) for name, (points, faces) in room(SQUARE, 0.1, roof=True).items()}
    structure = recognise_structure(scene({"land": land} | cellar | {"table": table(1.5, 1.5, -3)}))
    assert -3.0 in [round(found.floor, 3) for found in structure.rooms if found.indoors]

"""Dioramas: floors with walls on some sides, of any size; backdrops around rooms; rooms whose faces look outwards."""

from __future__ import annotations

import numpy as np
import pytest

from unisg_blender.spatial.structure import recognise_structure
from unisg_blender.spatial.structure.structure_text import structure_lines

from .built_rooms import SQUARE, box, joined, overlap, room, scene, slab, table, walls

WIDE = 4 * SQUARE
LARGE = np.array([[-60, -50], [60, -50], [60, 50], [-60, 50]], float)


def diorama(height: float = 8.0):
    """A floor of 20 x 16 m with two walls, as high as these."""
    sides = walls(WIDE, 0, height, 0.2)
    return {"base": joined([slab(WIDE, -0.2, 0.0), sides[0], sides[3]])}


def aquarium(height: float = 1.0):
    """A box of glass of 4 x 3 m on a stand, open to no side, with a lid."""
    inner = np.array([[8, 6], [12, 6], [12, 9], [8, 9]], float)
    top = height + 2.4
    sides = walls(inner, height, top, 0.05)
    return {"tank": joined([slab(inner, 0, height), *sides, slab(inner, top, top + 0.1)])}


def test_an_aquarium_on_a_stage_is_no_room() -> None:
    """It is as large as a room and closed all around, but stands on a wide floor between higher walls."""
    structure = recognise_structure(scene(diorama() | aquarium() | {"desk": table(3, 3, 0)}))
    (found,) = structure.rooms
    assert not found.indoors
    assert found.floor == pytest.approx(0)
    assert overlap((found.outline,), (WIDE,)) > 0.95
    assert "walls are on too few of its sides" in structure.notes[0]


@pytest.mark.parametrize(
    "parts",
    [
        {"land": slab(WIDE, -0.3, 0.0)} | aquarium(0.5),  # a hut on a plinth, on open land
        diorama(2.0) | aquarium(0.5),  # a hut higher than the walls of its garden
        diorama() | aquarium(0.05),  # on the floor itself
    ],
)
def test_a_small_house_on_land_is_a_room(parts) -> None:
    rooms = recognise_structure(scene(parts)).rooms
    assert [round(found.area) for found in rooms if found.indoors] == [12]


def test_a_room_before_a_backdrop_is_the_room() -> None:
    """A floor and two walls of a hundred metres around a room without a third wall."""
    back = joined([slab(LARGE, -1.0, -0.9), *walls(LARGE, -1.0, 40.0, 0.1)[:2]])
    sides = walls(SQUARE, 0, 2.5, 0.1)
    parts = {"floor": slab(SQUARE, -0.1, 0.0), "side": joined(sides[:2]), "desk": table(2, 2, 0)}
    structure = recognise_structure(scene(parts | {"backdrop": back}))
    (found,) = structure.rooms
    assert found.floor == pytest.approx(0)
    assert overlap((found.outline,), (SQUARE,)) > 0.95
    assert structure.cell == pytest.approx(0.05)


def test_land_around_a_table_is_no_backdrop() -> None:
    structure = recognise_structure(scene({"land": slab(LARGE, -0.1, 0.0), "desk": table(2, 2, 0)}))
    assert [round(found.area) for found in structure.rooms] == [12000]


def test_a_small_diorama_is_asked_for_its_unit() -> None:
    parts = {name: (points / 10, faces) for name, (points, faces) in (diorama() | {"desk": table(3, 3, 0)}).items()}
    structure = recognise_structure(scene(parts))
    assert not structure.rooms
    assert "is its unit right" in structure.notes[0]


def test_a_room_whose_faces_look_outwards_is_asked_for_its_normals() -> None:
    """A cube with nothing in it may be a block or a room."""
    graph = scene({"House": box((0, 0, 0), (6, 6, 2.7))})
    structure = recognise_structure(graph)
    assert "the top of House, whose faces look outwards" in structure.notes[0]
    assert structure_lines(structure, graph)[0] == "no room, 1 open place on 1 storey"
    ground = recognise_structure(scene({"ground": slab(SQUARE, -0.3, 0.0)}))
    assert "normals" not in ground.notes[0]
    assert recognise_structure(scene(room(SQUARE, 0.1))).notes == ()

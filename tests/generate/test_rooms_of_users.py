"""What users do: name floors of several rooms, hang frames off the wall, hang lamps from a rail, lay scalpels down."""

from __future__ import annotations

import numpy as np
import pytest

from tests.spatial.built_rooms import L_SHAPE, SQUARE, box, mesh, room, scene
from unisg_blender.generate import Generator
from unisg_blender.generate.check.mesh_check import faults
from unisg_blender.generate.check.settled_scene import settle_rows
from unisg_blender.geometry.polygon import inside
from unisg_blender.pretrained import find_generator
from unisg_blender.scene import SceneBuilder, SceneGraph
from unisg_blender.scene.hierarchy import subtree, take
from unisg_blender.worlds import operating_room


@pytest.fixture(scope="module")
def living() -> Generator:
    return Generator.load(find_generator("living_room"))


@pytest.fixture(scope="module")
def operating() -> Generator:
    return Generator.load(find_generator("operating_room"))


def of_categories(parts: dict[str, tuple], category) -> SceneGraph:
    """Objects with a category each, as ``category`` says of their names."""
    builder = SceneBuilder("House")
    for name, part in parts.items():
        builder.add(name, uid=name, mesh=mesh(part), category=category(name))
    return builder.build()


@pytest.mark.parametrize("named", [True, False])
@pytest.mark.parametrize("wanted", ["room 0 ground", "room 1 ground", "room 2 ground"])
def test_on_a_floor_is_on_that_floor(living: Generator, wanted: str, named: bool) -> None:
    parts = {}
    for number in range(3):
        parts |= {f"room {number} {name}": part for name, part in room(SQUARE + np.array([7 * number, 0]), 0.1).items()}

    def kind(name: str) -> str:
        """What a user calls a part of the building, where it is called anything."""
        return ("Floor" if "ground" in name else "Wall") if named else ""

    made = living.add(of_categories(parts, kind), {"Chair": 2, "Plant": 1}, 1, on=wanted, behaviour=False)
    assert made.added == 3
    outline = SQUARE + np.array([7 * int(wanted.split()[1]), 0])
    for item in made.objects:
        assert item.support == wanted
        assert inside(outline, item.world[None, :2, 3])[0]


@pytest.mark.parametrize("seed", range(2))
def test_a_sofa_in_an_l_shaped_room_does_not_face_a_wall(living: Generator, seed: int) -> None:
    made = living.add(scene(room(L_SHAPE, 0.1)), {"Sofa": 1}, seed, behaviour=False)
    (item,) = made.objects
    assert not item.refused
    ahead = item.world[:2, 3] + item.world[:2, :2] @ np.array([0.0, -1.2])
    assert inside(L_SHAPE, ahead[None])[0]


@pytest.mark.parametrize("away", [0.0, 0.01, 0.02])
def test_a_frame_off_the_wall_keeps_its_height(away: float) -> None:
    parts = room(SQUARE, 0.1) | {"frame": box((2, away, 1.4), (2.6, away + 0.03, 1.9))}
    graph = scene(parts)
    (item,) = settle_rows(graph, [graph.row_of_uid["frame"]])
    assert not item.note
    expected = np.eye(4)
    expected[1, 3] = -away if away > 0.01 else 0.0  # onto the wall
    np.testing.assert_allclose(item.world, expected, atol=1e-6)


def without(graph: SceneGraph, *categories: str) -> SceneGraph:
    """A scene without the things of some categories and what is on them."""
    gone = np.zeros(len(graph), bool)
    for row in range(len(graph)):
        if graph.category_name(row) in categories:
            gone[subtree(graph, row)] = True
    return take(graph, np.flatnonzero(~gone))


def test_surgical_lamps_hang_from_the_rail(operating: Generator) -> None:
    graph = without(operating_room(21), "Surgical Lamp")
    made = operating.add(graph, {"Surgical Lamp": 2}, 3, behaviour=False)
    assert made.added
    assert not faults(made.scene, graph, [item.uid for item in made.objects if item.uid])
    assert {item.support.split(".")[0] for item in made.objects if item.uid} == {"Ceiling Rail"}


def test_scalpels_lie_on_a_stand_and_not_on_its_foot(operating: Generator) -> None:
    graph = without(operating_room(22), "Scalpel", "Kidney Dish")
    stand = next(uid for row, uid in enumerate(graph.uid) if graph.category_name(row) == "Mayo Stand")
    made = operating.add(graph, {"Scalpel": 3}, 5, on=stand, behaviour=False)
    assert made.added
    assert all(item.world[2, 3] > 0.6 for item in made.objects if item.uid)

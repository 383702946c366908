"""What is placed leaves the floor in one piece, unless that is not wanted; Check tells what does not."""

from __future__ import annotations

import numpy as np
import pytest

from tests.metrics.hand_made import Scene, box_mesh
from unisg_blender.dataset.assets.asset import object_graph
from unisg_blender.generate.check.scene_check import check_scene
from unisg_blender.generate.observe.placeable import Placeable
from unisg_blender.generate.place.ways_kept import CLEAR, CUTS, ROUND, WaysKept
from unisg_blender.spatial.structure.room_objects import room_objects


def ways(*things: tuple[float, float, float, float, float]) -> WaysKept:
    """The ways in a room of 6 m by 4 m with boxes: width, depth, height, x, y."""
    scene = Scene()
    for number, (width, depth, height, x, y) in enumerate(things):
        scene.box(f"box {number}", (width, depth, height), (x, y, 0))
    graph = scene.build()
    room = room_objects(graph, graph.vocabulary)
    return WaysKept(room, np.ones(len(room.objects), bool))


def thing(width: float, depth: float, height: float) -> Placeable:
    scene = Scene()
    scene.box("thing", None, (0, 0, 0), mesh=box_mesh(((width, depth, height), (0, 0, 0))))
    return Placeable(object_graph(scene.build(), 1))


def place(x: float, y: float, z: float = 0.0, yaw: float = 0.0) -> np.ndarray:
    return np.array([x, y, z, yaw])


@pytest.mark.parametrize(
    ("size", "at", "kept"),
    [
        ((0.4, 3.9, 1.0), place(0, 0), CUTS),
        ((0.4, 3.9, 1.0), place(0, 0, yaw=np.pi / 2), CLEAR),
        ((0.4, 3.9, 1.0), place(0, 0, z=2.0), CLEAR),
        ((0.4, 3.9, 0.02), place(0, 0), ROUND),
        ((0.4, 3.0, 1.0), place(0, -0.5), CLEAR),
    ],
)
def test_a_row_of_things_cuts_the_floor_a_rug_only_for_judges(size, at, kept: int) -> None:
    assert ways().kept(thing(*size), at) == kept


def test_the_first_place_that_is_clear_is_taken() -> None:
    room, shelf = ways((0.4, 2.0, 1.0, 0, -1)), thing(0.4, 1.8, 1.0)
    places = np.array([place(0, 1.0), place(2, 1.0), place(-2, 1.0)])
    assert room.best(shelf, places, np.array([True, True, True])) == 1
    assert room.best(shelf, places, np.array([True, False, True])) == 2
    assert room.best(shelf, places, np.array([True, False, False])) == -1
    room.wanted = False
    assert room.best(shelf, places, np.array([True, True, True])) == 0


def test_what_was_cut_before_may_stay_so_but_gets_no_worse() -> None:
    room = ways((0.4, 4.0, 1.0, 0, 0))
    assert room.kept(thing(0.4, 1.0, 1.0), place(2, 0)) == CLEAR
    assert room.kept(thing(0.4, 3.9, 1.0), place(1.5, 0)) == CUTS


def test_check_tells_what_cuts_a_room_that_categories_tell() -> None:
    scene = Scene()
    scene.box("shelf", (0.4, 2.0, 1.8), (0, -1, 0), category="Bookshelf")
    assert check_scene(scene.build()).faults == ()
    scene.box("board", (0.4, 1.95, 1.5), (0, 1.0, 0), category="Bookshelf")
    (fault,) = check_scene(scene.build()).faults
    assert (fault.row, fault.text) == (1, "blocks the way through the room")

"""What users call a door or a window is one, whether a hole is there or not; and how many rooms and places are told."""

from __future__ import annotations

import numpy as np
import pytest

from unisg_blender.geometry.planar import turn
from unisg_blender.scene import SceneBuilder, SceneGraph
from unisg_blender.scene.structure_marks import THING, with_parts
from unisg_blender.spatial.structure import recognise_structure
from unisg_blender.spatial.structure.doorways import doorways
from unisg_blender.spatial.structure.structure_text import structure_lines
from unisg_blender.worlds import living_room

from .built_rooms import DOOR, SQUARE, box, mesh, room, scene, slab

LEAF = box((1.0, -0.08, 0.0), (1.9, -0.03, 2.0))
PANE = box((5.03, 1.0, 0.9), (5.07, 2.2, 2.0))


def with_named(parts, named, move=None) -> SceneGraph:
    """A scene of a building, and of things by category."""
    matrix = np.eye(4) if move is None else move
    builder = SceneBuilder("Built")
    for name, part in parts.items():
        builder.add(name, uid=name, mesh=mesh(part), local=matrix)
    for number, (category, part) in enumerate(named):
        builder.add(category, uid=f"{category} {number}", category=category, mesh=mesh(part), local=matrix)
    return builder.build()


def told(graph: SceneGraph) -> list[str]:
    return sorted(opening.kind for found in recognise_structure(graph).rooms for opening in found.openings)


@pytest.mark.parametrize("holes", [(), (DOOR,)])
@pytest.mark.parametrize("degrees", [0, 35])
def test_a_named_door_is_one_with_and_without_a_hole(holes, degrees) -> None:
    graph = with_named(
        room(SQUARE, 0.1, holes=holes), [("Door", LEAF), ("Window", PANE)], turn(np.radians(degrees))
    )  # fmt: skip
    assert told(graph) == ["door", "window"]
    (found,) = recognise_structure(graph).rooms
    door, window = sorted(found.openings, key=lambda opening: opening.kind)
    back = turn(np.radians(-degrees))[:2, :2]
    np.testing.assert_allclose(sorted((back @ end)[0] for end in (door.start, door.stop)), [1.0, 1.9], atol=0.02)
    assert (door.bottom, round(door.top, 3)) == (0.0, 2.0)
    assert (round(window.bottom, 3), round(window.top, 3)) == (0.9, 2.0)
    assert len(doorways((found,)).center) == 1


def test_what_a_user_calls_a_window_is_none_of_the_doors() -> None:
    assert told(with_named(room(SQUARE, 0.1, holes=(DOOR,)), [])) == ["door"]
    assert told(with_named(room(SQUARE, 0.1, holes=(DOOR,)), [("Window", LEAF)])) == ["window"]


def test_a_door_between_two_rooms_is_one_of_both() -> None:
    one = room(SQUARE, 0.1)
    parts = one | {f"right {name}": (points + np.array([5.1, 0, 0]), faces) for name, (points, faces) in one.items()}
    assert told(with_named(parts, [("Door", box((5.03, 1.0, 0.0), (5.07, 1.9, 2.0)))])) == ["door", "door"]


@pytest.mark.parametrize(
    "part",
    [
        box((2.0, 2.0, 0.0), (2.9, 2.04, 2.0)),  # in the middle of the room
        box((1.0, -0.05, 0.0), (1.05, 0.85, 2.0)),  # a leaf that stands open
        box((1.0, -0.08, 2.6), (1.9, -0.03, 4.6)),  # of the storey above
        box((1.0, -0.08, 0.9), (1.9, -0.03, 1.4)),  # of a cupboard on the wall
    ],
)
def test_what_is_called_a_door_and_is_in_no_wall_is_none(part) -> None:
    assert told(with_named(room(SQUARE, 0.1, roof=True), [("Door", part)])) == []


def test_a_door_that_is_marked_as_a_thing_is_none() -> None:
    graph = with_named(room(SQUARE, 0.1), [("Door", LEAF)])
    assert told(with_parts(graph, {graph.row_of_uid["Door 0"]: THING})) == []


@pytest.mark.parametrize("seed", range(4))
def test_living_rooms_have_their_doors_and_windows(seed) -> None:
    graph = living_room(seed)
    said = sorted(name.lower() for name in map(graph.category_name, range(len(graph))) if name in ("Door", "Window"))
    assert said
    assert told(graph) == said


def test_rooms_and_open_places_are_counted_apart() -> None:
    """An open place alone had been "1 room", and "no room was found" below it."""
    graph = scene({"stage": slab(SQUARE, -0.1, 0.0)})
    assert structure_lines(recognise_structure(graph), graph)[0] == "no room, 1 open place on 1 storey"
    whole = np.array([[0, 0], [10, 0], [10, 4], [0, 4]], float)
    half = scene(room(whole, 0.2) | {"roof": slab(SQUARE, 2.5, 2.6)})
    assert structure_lines(recognise_structure(half), half)[0] == "1 room, 1 open place on 1 storey"

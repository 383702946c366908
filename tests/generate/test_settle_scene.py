"""Settling objects of a scene: onto their support, apart, into the room; what stands on them comes along."""

from __future__ import annotations

import numpy as np
import pytest

from tests.generate.rooms import at, box
from tests.spatial.built_rooms import SQUARE, room, slab
from tests.spatial.built_rooms import box as ordinary
from tests.spatial.built_rooms import scene as built
from unisg_blender.generate.check.settled_scene import settle_rows
from unisg_blender.scene import SceneBuilder, SceneGraph, mesh_from_faces


def scene(**places: np.ndarray) -> SceneGraph:
    """A floor of 4 x 4 m with a table, a cup on it and a crate."""
    builder = SceneBuilder("Room")
    floor = builder.add("Floor", uid="floor", local=at(0, 0, -0.1), mesh=box("Floor", 4, 4, 0.1), category="Floor")
    table = builder.add(
        "Table", uid="table", parent=floor, local=places.get("table", at(0, 0, 0.1)), mesh=box("Table", 1.2, 0.7, 0.8),
        category="Table",
    )  # fmt: skip
    builder.add(
        "Cup", uid="cup", parent=table, local=places.get("cup", at(0, 0, 0.8)), mesh=box("Cup", 0.08, 0.08, 0.1),
        category="Cup",
    )  # fmt: skip
    builder.add(
        "Crate", uid="crate", parent=floor, local=places.get("crate", at(1.5, 1.5, 0.1)),
        mesh=box("Crate", 0.4, 0.4, 0.4), category="Crate",
    )  # fmt: skip
    return builder.build()


def settled(graph: SceneGraph, *uids: str) -> dict[str, np.ndarray]:
    found = settle_rows(graph, [graph.row_of_uid[uid] for uid in uids])
    assert not any(item.note for item in found)
    return {graph.uid[item.row]: item.world[:3, 3] for item in found}


def test_what_stands_well_stays() -> None:
    found = settled(scene(), "table", "cup", "crate")
    np.testing.assert_allclose(found["table"], [0, 0, 0], atol=1e-6)
    np.testing.assert_allclose(found["cup"], [0, 0, 0.8], atol=1e-6)
    np.testing.assert_allclose(found["crate"], [1.5, 1.5, 0], atol=1e-6)


def test_floating_and_sunk_things_come_onto_what_is_below() -> None:
    found = settled(scene(cup=at(0.2, 0.1, 1.3), crate=at(1.5, 1.5, 0.02)), "cup", "crate")
    np.testing.assert_allclose(found["cup"], [0.2, 0.1, 0.8], atol=1e-6)
    np.testing.assert_allclose(found["crate"], [1.5, 1.5, 0], atol=1e-6)


def test_overlapping_things_are_parted_and_come_into_the_room() -> None:
    found = settled(scene(crate=at(0.5, 0.2, 0.1)), "crate")["crate"]
    assert max(abs(found[0]) - 0.6 - 0.2, abs(found[1]) - 0.35 - 0.2) >= -0.0011
    np.testing.assert_allclose(found[2], 0, atol=1e-6)
    assert np.abs(settled(scene(crate=at(2.1, 0, 0.1)), "crate")["crate"][:2]).max() <= 1.8011


def test_what_stands_on_a_moved_thing_comes_along() -> None:
    graph = scene(table=at(0, 0, 0.5), crate=at(0, 0.9, 0.1))
    found = settled(graph, "table", "cup")
    np.testing.assert_allclose(found["table"], [0, 0, 0], atol=1e-6)
    np.testing.assert_allclose(found["cup"], [0, 0, 0.8], atol=1e-6)


def test_structure_is_left_alone_and_what_finds_no_place_is_told() -> None:
    assert settle_rows(scene(), [scene().row_of_uid["floor"]]) == []
    builder = SceneBuilder("Tiny")
    floor = builder.add("Floor", uid="f", local=at(0, 0, -0.1), mesh=box("Floor", 1, 1, 0.1), category="Floor")
    for uid in ("a", "b"):
        builder.add(uid, uid=uid, parent=floor, local=at(0, 0, 0.1), mesh=box("T", 0.9, 0.9, 0.8), category="Table")
    graph = builder.build()
    (item,) = settle_rows(graph, [graph.row_of_uid["b"]])
    assert "no free place" in item.note


def test_what_would_still_hang_in_the_air_or_be_in_something_stays_and_is_told() -> None:
    """A crate over a stack whose box is larger than what is there: no face of it is below the crate."""
    builder = SceneBuilder("Room")
    floor = builder.add("Floor", uid="floor", local=at(0, 0, -0.1), mesh=box("Floor", 6, 6, 0.1), category="Floor")
    tent = mesh_from_faces("Tent", [[-1, -1, 0], [1, -1, 0], [0, 0, 2.5], [1, 1, 0], [-1, 1, 0]],
                           [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2]])  # fmt: skip
    builder.add("Tent", uid="tent", parent=floor, local=at(0, 0, 0.1), mesh=tent, category="Tent")
    builder.add("Crate", uid="crate", local=at(0.5, 0.0, 3.0), mesh=box("Crate", 0.3, 0.3, 0.3), category="Crate")
    graph = builder.build()
    (item,) = settle_rows(graph, [graph.row_of_uid["crate"]])
    assert item.note == "it would be in the air"
    np.testing.assert_allclose(item.world, graph.world[item.row])


def test_a_bench_on_the_lawn_may_stay_outside() -> None:
    objects = room(SQUARE, 0.1, roof=True) | {"lawn": slab(SQUARE * 6 - 10, -0.3, -0.15)}
    graph = built(objects | {"bench": ordinary((10, 8, 0.3), (11, 8.5, 0.8))})
    (item,) = settle_rows(graph, [graph.row_of_uid["bench"]])
    assert not item.note
    assert item.world[2, 3] == pytest.approx(-0.45, abs=1e-3)


def test_things_settle_in_the_room_that_they_are_in() -> None:
    """The smaller of two rooms is theirs, though the larger one is the room of the scene."""
    far = SQUARE * 0.7 + np.array([8, 0])
    objects = room(SQUARE, 0.1) | {f"far {name}": part for name, part in room(far, 0.1).items()}
    objects |= {"crate": ordinary((9, 1, 0.7), (9.4, 1.4, 1.1)), "pot": ordinary((2, 1, 0.7), (2.4, 1.4, 1.1))}
    graph = built(objects)
    found = settle_rows(graph, [graph.row_of_uid[name] for name in ("crate", "pot")])
    assert [item.note for item in found] == ["", ""]
    np.testing.assert_allclose([item.world[2, 3] for item in found], -0.7, atol=1e-3)


def furnished(sofa: np.ndarray, chair: np.ndarray) -> SceneGraph:
    """A floor of 6 x 6 m with a sofa (back and seat) along a side, and a chair."""
    builder = SceneBuilder("Room")
    floor = builder.add("Floor", uid="floor", local=at(0, 0, -0.1), mesh=box("Floor", 6, 6, 0.1), category="Floor")
    held = builder.add("Sofa", uid="sofa", parent=floor, local=sofa, category="Sofa")
    builder.add("Seat", uid="seat", parent=held, mesh=box("Seat", 2, 0.9, 0.42))
    builder.add("Back", uid="back", parent=held, local=at(0, 0.35, 0.42), mesh=box("Back", 2, 0.2, 0.4))
    builder.add("Chair", uid="chair", parent=floor, local=chair, mesh=box("Chair", 0.5, 0.5, 0.9), category="Chair")
    return builder.build()


@pytest.mark.parametrize("x", [0.0, 0.4, 0.9])
def test_a_chair_within_a_sofa_comes_to_stand_on_the_floor_beside_it(x: float) -> None:
    found = settled(furnished(at(0, 2.4, 0.1), at(x, 2.2, 0.1)), "chair")["chair"]
    assert found[2] == pytest.approx(0, abs=1e-6)
    assert max(abs(found[0]) - 1 - 0.25, abs(found[1] - 2.4) - 0.45 - 0.25) >= -0.0011
    assert np.linalg.norm(found[:2] - [x, 2.2]) < 0.6, "the nearest free place is right before the sofa"


def test_what_has_no_room_on_what_is_below_it_comes_onto_the_next_thing_below() -> None:
    """A crate over a table that is full goes to the floor beside."""
    builder = SceneBuilder("Room")
    floor = builder.add("Floor", uid="floor", local=at(0, 0, -0.1), mesh=box("Floor", 6, 6, 0.1), category="Floor")
    table = builder.add(
        "Table", uid="table", parent=floor, local=at(0, 0, 0.1), mesh=box("Table", 1, 1, 0.7), category="Table"
    )
    for x in (-0.35, 0.35):
        builder.add(
            "Box", uid=f"box {x}", parent=table, local=at(x, 0, 0.7), mesh=box("Box", 0.3, 1, 0.6), category="Box"
        )
    builder.add("Crate", uid="crate", local=at(0.1, 0, 0.75), mesh=box("Crate", 0.8, 0.8, 0.8), category="Crate")
    graph = builder.build()
    found = settled(graph, "crate")["crate"]
    assert found[2] == pytest.approx(0, abs=1e-6)
    assert 0.89 < np.abs(found[:2]).max() < 1.1


def test_what_is_sunk_into_a_rug_stays_on_it() -> None:
    builder = SceneBuilder("Room")
    floor = builder.add("Floor", uid="floor", local=at(0, 0, -0.1), mesh=box("Floor", 6, 6, 0.1), category="Floor")
    builder.add("Rug", uid="rug", parent=floor, local=at(0, 0, 0.1), mesh=box("Rug", 2, 2, 0.04), category="Rug")
    builder.add(
        "Crate", uid="crate", parent=floor, local=at(0.3, 0, 0.1), mesh=box("Crate", 0.8, 0.8, 0.8), category="Crate"
    )
    np.testing.assert_allclose(settled(builder.build(), "crate")["crate"], [0.3, 0, 0.04], atol=1e-6)

"""New objects in rooms of others: inside, on the floor, in nothing, whatever the room is made of."""

from __future__ import annotations

import numpy as np
import pytest

from tests.spatial.built_rooms import (
    DOOR,
    L_SHAPE,
    SQUARE,
    TRIANGLE,
    box,
    grown,
    joined,
    mesh,
    room,
    scene,
    slab,
    table,
    walls,
)  # fmt: skip
from unisg_blender.generate import Generator
from unisg_blender.generate.check.settled_scene import settle_rows
from unisg_blender.geometry.box_overlap import penetration
from unisg_blender.geometry.boxes import Boxes
from unisg_blender.geometry.planar import turn
from unisg_blender.geometry.polygon import outside_distance
from unisg_blender.pretrained import find_generator
from unisg_blender.scene import SceneBuilder
from unisg_blender.scene import table as table_of
from unisg_blender.scene.components import VISIBILITY
from unisg_blender.spatial import find_relations
from unisg_blender.spatial.part_boxes import part_boxes

COUNTS = {"Chair": 2, "Plant": 2, "Bookshelf": 1, "Armchair": 1}


@pytest.fixture(scope="module")
def generator() -> Generator:
    return Generator.load(find_generator("living_room"))


def check(made, outline, floor: float, least: int = 6) -> None:
    """All new objects stand on the floor, in the outline, and in no other new object."""
    assert made.added >= least
    graph, boxes = made.scene, part_boxes(made.scene)
    for placement in made.objects:
        if placement.refused:
            continue
        row = graph.row_of_uid[placement.uid]
        mesh = graph.meshes[graph.mesh[row]] if graph.mesh[row] >= 0 else None
        points = np.concatenate([_points(graph, below) for below in _with_below(graph, row)])
        assert mesh is None or len(points)
        assert outside_distance(outline, points[:, :2]).max() <= 0.002
        assert points[:, 2].min() == pytest.approx(floor, abs=0.02)
    rows = [set(_with_below(graph, graph.row_of_uid[item.uid])) for item in made.objects if not item.refused]
    for one in range(len(rows)):
        for two in range(one):
            first, second = (np.flatnonzero(np.isin(boxes.owner, list(rows[number]))) for number in (one, two))
            pairs = np.stack(np.meshgrid(first, second), axis=-1).reshape(-1, 2)
            assert penetration(boxes.boxes.take(pairs[:, 0]), boxes.boxes.take(pairs[:, 1])).max() <= 0.05


def _with_below(graph, row: int) -> list[int]:
    found = [row]
    for below in range(row + 1, len(graph)):
        if int(graph.parent[below]) in found:
            found.append(below)
    return found


def _points(graph, row: int) -> np.ndarray:
    if graph.mesh[row] < 0:
        return np.zeros((0, 3))
    points = graph.meshes[graph.mesh[row]].points.astype(float)
    return points @ graph.world[row, :3, :3].T + graph.world[row, :3, 3]


@pytest.mark.parametrize("one", ["", "walls", "all"])
@pytest.mark.parametrize(("name", "outline"), [("square", SQUARE), ("l", L_SHAPE), ("triangle", TRIANGLE)])
def test_rooms_of_any_make_without_categories(generator, one, name, outline) -> None:
    made = generator.add(scene(room(outline, 0.1, roof=True, holes=(DOOR,), one=one)), COUNTS, 3)
    check(made, outline, 0.0)


@pytest.mark.parametrize("degrees", [15, 30, 45, 75])
@pytest.mark.parametrize("baked", [True, False])
def test_turned_rooms(generator, degrees, baked) -> None:
    matrix = turn(np.radians(degrees))
    matrix[:3, 3] = 3, -8, 1.2
    made = generator.add(scene(room(L_SHAPE, 0.1, holes=(DOOR,)), matrix, baked), COUNTS, 3)
    check(made, L_SHAPE @ matrix[:2, :2].T + matrix[:2, 3], 1.2)


def test_a_house_on_land_with_a_desk_in_the_way(generator) -> None:
    land = slab(np.array([[-30, -30], [30, -30], [30, 30], [-30, 30]], float), -1.0, -0.05)
    objects = room(SQUARE, 0.2, roof=True, holes=(DOOR,)) | {"land": land, "roof": slab(grown(SQUARE, 0.6), 2.6, 2.7)}
    desk = table(2.5, 2.0, 0.0)
    made = generator.add(scene(objects | {"desk": desk}), COUNTS, 5)
    check(made, SQUARE, 0.0)
    merged = generator.add(scene({"house": joined([*objects.values(), desk])}), COUNTS, 5)
    check(merged, SQUARE, 0.0)
    top = Boxes(np.array([[2.5, 2.0, 0.375]]), np.eye(3)[None], np.array([[0.6, 0.4, 0.37]]), np.ones(1, bool))
    for result in (made, merged):  # nothing stands in the desk, though it is part of the house
        boxes = part_boxes(result.scene)
        new = np.flatnonzero(np.isin(boxes.owner, result.rows))
        high = boxes.boxes.take(new)
        tall = high.take(np.flatnonzero(high.half[:, 2] > 0.3))
        assert (
            penetration(tall, Boxes(*(np.repeat(part, len(tall.center), 0) for part in vars(top).values()))).max()
            < 0.05
        )


def test_no_room_is_brought_into_one(generator) -> None:
    graph = scene(room(SQUARE, 0.1))
    assert not {"Floor", "Wall", "Door", "Window"} & set(generator.sample_counts(np.random.default_rng(1), graph))
    made = generator.add(graph, {"Floor": 1, "Wall": 2, "Chair": 1}, 1)
    assert [item.category for item in made.refused] == ["Floor", "Wall", "Wall"]
    assert {item.note for item in made.refused} == {"there is a room already"}
    check(made, SQUARE, 0.0, least=1)


def test_the_room_that_a_thing_is_in_is_the_one(generator) -> None:
    far = SQUARE * 0.8 + np.array([8, 0])
    objects = room(SQUARE, 0.1) | {f"far {name}": part for name, part in room(far, 0.1).items()}
    objects["crate"] = box((9.5, 1.0, 0.0), (9.9, 1.4, 0.5))
    made = generator.add(scene(objects), {"Plant": 1}, 1, beside="crate")
    check(made, far, 0.0, least=1)
    made = generator.add(scene(objects), {"Plant": 1}, 1, on="far ground")
    check(made, far, 0.0, least=1)


def test_things_settle_onto_the_floor_of_a_house_of_one_mesh() -> None:
    house = room(SQUARE, 0.2, roof=True, holes=(DOOR,), one="all")
    counter = box((0.0, 3.4, 0.0), (3.0, 4.0, 0.9))
    objects = {"house": joined([house["house"], counter])}
    objects["crate"] = box((2, 1, 1.7), (2.5, 1.5, 2.2))
    objects["pot"] = box((1.0, 3.6, 1.0), (1.2, 3.8, 1.2))
    graph = scene(objects)
    found = settle_rows(graph, [graph.row_of_uid[name] for name in objects])
    moved = {graph.name[item.row]: item.world[2, 3] for item in found}
    assert moved.keys() == {"crate", "pot"}  # the house is no thing to settle
    assert moved["crate"] == pytest.approx(-1.7, abs=1e-3)
    assert moved["pot"] == pytest.approx(-0.1, abs=1e-3)


def on_desk(generator, tilt: float, hidden: bool):
    """Books wanted on a desk, tilted by so many degrees, on which a block lies that may be hidden."""
    cos, sin = np.cos(np.radians(tilt)), np.sin(np.radians(tilt))
    tilted = np.eye(4)
    tilted[1:3, 1:3], tilted[2, 3] = [[cos, -sin], [sin, cos]], 0.72
    builder = SceneBuilder("Built")
    for name, part in room(SQUARE, 0.1).items():
        builder.add(name, uid=name, mesh=mesh(part))
    middle = np.eye(4)
    middle[:2, 3] = 2.5, 2.0
    builder.add("desk", uid="desk", mesh=mesh(box((-0.7, -0.35, -0.02), (0.7, 0.35, 0.02))), local=middle @ tilted)
    block = builder.add("block", uid="block", mesh=mesh(box((-0.7, -0.35, 0.74), (0.7, 0.35, 1.5))), local=middle)
    graph = builder.build()
    if hidden:
        everywhere = np.ones(1, bool)
        shown = table_of([graph.row_of_uid["block"]], hidden=everywhere, viewport=everywhere, render=everywhere)
        graph = graph.with_component(VISIBILITY, shown)
    assert block >= 0
    return generator.add(graph, {"Book": 2}, 1, on="desk")


@pytest.mark.parametrize(("tilt", "hidden", "added"), [(0, True, 2), (0, False, 0), (30, True, 0), (5, True, 2)])
def test_things_go_onto_what_is_level_and_not_into_what_is_seen(generator, tilt, hidden, added) -> None:
    made = on_desk(generator, tilt, hidden)
    assert made.added == added
    held = {
        made.scene.name[row]: made.scene.name[on] for row, kind, on in find_relations(made.scene) if kind == "on_top_of"
    }
    if not tilt:
        assert [held.get(item.name) for item in made.objects if not item.refused] == ["desk"] * added


def test_a_thing_around_the_room_leaves_it_free(generator) -> None:
    """Skirtings of all walls in one mesh, an L-shaped counter: their boxes are the room, they are not."""
    skirting = joined(walls(SQUARE * 0.98 + 0.04, 0.0, 0.35, 0.02))
    counter = joined([box((0.1, 2.9, 0), (3.4, 3.5, 0.9)), box((2.8, 0.9, 0), (3.4, 2.9, 0.9))])
    for thing in (skirting, counter):
        check(generator.add(scene(room(SQUARE, 0.1) | {"thing": thing}), {"Chair": 2, "Plant": 1}, 2), SQUARE, 0.0, 3)

"""Requests: on an object, beside an object, and objects that are not there."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tests.generate.rooms import at, box, room
from unisg_blender.cli import main
from unisg_blender.errors import UniSGError
from unisg_blender.generate import Generator
from unisg_blender.generate.observe.observed_scene import ObservedScene
from unisg_blender.generate.observe.placeable import box_placeable
from unisg_blender.generate.propose.proposer import Proposals, Proposer, Query
from unisg_blender.generate.propose.requests import APART, BESIDE, Beside, aside
from unisg_blender.metrics.requested_relations import is_beside, is_on
from unisg_blender.scene import Mesh, Relation, SceneBuilder, SceneGraph, world_matrices
from unisg_blender.spatial.objects import scene_objects
from unisg_blender.usd import write_usd

pytestmark = pytest.mark.slow

KNOWN = ("Cup", "Floor", "Lamp", "Table", "Wall")


@pytest.fixture(scope="module")
def generator(model_file: Path) -> Generator:
    return Generator.load(model_file)


def row_of(graph: SceneGraph, category: str) -> int:
    return int(np.flatnonzero(graph.category == graph.vocabulary.index(category))[0])


def test_what_is_wanted_on_a_thing_stands_on_it(generator: Generator) -> None:
    scene = room(100, cups=1)
    table = scene.uid[row_of(scene, "Table")]
    for seed in range(4):
        result = generator.add(scene, {"Cup": 2}, seed=seed, on=table)
        assert result.added > 0
        assert all(is_on(result.scene, int(row), table) for row in result.rows)


def test_a_support_that_was_never_seen_is_taken_if_it_is_asked_for(generator: Generator) -> None:
    scene = room(100, cups=1)
    floor = scene.uid[row_of(scene, "Floor")]
    result = generator.add(scene, {"Cup": 1}, seed=0, on=floor)
    assert result.added == 1
    assert is_on(result.scene, int(result.rows[0]), floor)


def with_object(category: str, name: str, mesh: Mesh, place: np.ndarray, on: str) -> SceneGraph:
    """A room of a floor and a table, and one object more on one of these."""
    builder = SceneBuilder("Small room")
    rows = {
        "Floor": builder.add("Floor", uid="floor", local=at(0, 0, -0.1), mesh=box("Floor", 5, 5, 0.1), category="Floor")
    }
    rows["Table"] = builder.add(
        "Table", uid="table", parent=rows["Floor"], local=at(0.5, 0, 0.1), mesh=box("Table", 1.2, 0.7, 0.8),
        category="Table", relations=(Relation("on_top_of", "floor"),),
    )  # fmt: skip
    builder.add(name, uid="more", parent=rows[on], local=place, mesh=mesh, category=category)
    return builder.build()


def test_a_cloth_that_covers_a_table_is_the_place_on_the_table(generator: Generator) -> None:
    scene = with_object("Cloth", "Cloth", box("cloth", 1.2, 0.7, 0.01), at(0, 0, 0.8), "Table")
    result = generator.add(scene, {"Cup": 2}, seed=1, on="Table")
    assert result.added == 2
    assert {result.scene.name[result.scene.parent[row]] for row in result.rows} == {"Cloth"}
    assert all(is_on(result.scene, int(row), "table") for row in result.rows)
    small = with_object("Cloth", "Cloth", box("cloth", 0.3, 0.2, 0.01), at(0, 0, 0.8), "Table")
    uncovered = generator.add(small, {"Cup": 1}, seed=1, on="Table")
    assert uncovered.scene.name[uncovered.scene.parent[uncovered.rows[0]]] == "Table"


def test_what_finds_no_room_beside_a_thing_says_so(generator: Generator) -> None:
    scene = with_object("Table", "High", box("High", 1.0, 0.7, 0.8), at(0.5, 0, 3.0), "Floor")
    result = generator.add(scene, {"Cup": 1}, seed=1, beside="High")
    assert result.added == 1  # on one of the tables: there is nothing at the same height
    assert result.objects[0].note == "no room beside High"


def test_beside_works_where_there_is_no_floor(generator: Generator) -> None:
    builder = SceneBuilder("Loose things")
    builder.add("Table", uid="table", local=at(0, 0, 0), mesh=box("Table", 1.2, 0.7, 0.8), category="Table")
    result = generator.add(builder.build(), {"Table": 1}, seed=2, beside="Table")
    assert result.added == 1


def test_what_is_wanted_beside_a_thing_stands_beside_it(generator: Generator) -> None:
    scene = room(100, cups=1)
    cup = scene.uid[row_of(scene, "Cup")]
    found = [generator.add(scene, {"Cup": 1}, seed=seed, beside=cup) for seed in range(6)]
    near = [is_beside(result.scene, int(row), cup) for result in found for row in result.rows]
    assert len(near) == 6
    assert np.mean(near) > 0.8


def test_what_the_model_puts_elsewhere_is_shifted_to_beside_the_thing() -> None:
    graph = room(100, cups=1)
    objects = scene_objects(graph, KNOWN)
    scene = ObservedScene.of(objects, world_matrices(graph)[objects.row])
    table = int(np.flatnonzero(objects.category == KNOWN.index("Table"))[0])

    class Far(Proposer):
        def propose(self, query: Query, count: int, rng: np.random.Generator) -> Proposals:
            bottom = scene.center[table, 2] - scene.half[table, 2]
            return Proposals(np.full(count, 0), np.tile([9.0, 9.0, bottom, 0.3], (count, 1)))

    placeable = box_placeable("Table", [0.6, 0.4, 0.8])
    query = Query(scene, 3, placeable, np.ones(len(objects), bool), {})
    found = Beside(Far(), table).propose(query, 8, np.random.default_rng(0))
    gaps = aside(scene, table, placeable.half, found.places)
    assert len(gaps) == 8
    assert (gaps >= -1e-9).all()
    assert (gaps <= BESIDE + 1e-9).all()
    assert (found.places[:, 3] == 0.3).all()


def test_a_thing_may_be_given_by_its_name(generator: Generator) -> None:
    scene = room(100, cups=1)
    row = row_of(scene, "Table")
    by_name = generator.add(scene, {"Cup": 1}, seed=3, on=scene.name[row])
    by_uid = generator.add(scene, {"Cup": 1}, seed=3, on=scene.uid[row])
    np.testing.assert_array_equal(by_name.scene.local, by_uid.scene.local)


def test_things_that_are_not_there_or_many_are_told(generator: Generator) -> None:
    scene = room(100, cups=2)
    with pytest.raises(UniSGError, match="nothing in the scene is called 'Sofa'"):
        generator.add(scene, {"Cup": 1}, seed=0, on="Sofa")
    with pytest.raises(UniSGError, match="everything is beside"):
        generator.add(scene, {"Cup": 1}, seed=0, beside=scene.uid[row_of(scene, "Floor")])
    alike = scene.replace(name=tuple("Same" for _ in scene.name))
    with pytest.raises(UniSGError, match="objects are called 'Same'"):
        generator.add(alike, {"Cup": 1}, seed=0, beside="Same")


def test_gaps_are_those_of_footprints_on_a_common_height() -> None:
    graph = room(100, cups=1)
    objects = scene_objects(graph, graph.vocabulary)
    scene = ObservedScene.of(objects, world_matrices(graph)[objects.row])
    table = int(np.flatnonzero(objects.category == graph.vocabulary.index("Table"))[0])
    half = box_placeable("box", np.array([0.2, 0.2, 2 * objects.half[table, 2]])).half
    x, y, z = objects.center[table] - (0, 0, objects.half[table, 2])
    yaw = objects.yaw[table]
    away = objects.half[table, 0] + 0.1 + 0.3
    places = np.array([
        [x + away * np.cos(yaw), y + away * np.sin(yaw), z, yaw],
        [x, y, z, yaw],
        [x + away * np.cos(yaw), y + away * np.sin(yaw), z + 5.0, yaw],
    ])  # fmt: skip
    gaps = aside(scene, table, half, places)
    assert gaps[0] == pytest.approx(0.3)
    assert gaps[1] < 0
    assert gaps[2] == pytest.approx(APART + 0.3)  # at another height: last
    assert BESIDE == 0.5


def test_the_command_line_takes_requests(model_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = room(100, cups=1)
    write_usd(scene, tmp_path / "room.usda")
    name = scene.name[row_of(scene, "Table")]
    words = ["generate", "--model", str(model_file), "--scene", str(tmp_path / "room.usda"), "--seed", "1", "--json"]
    out = tmp_path / "more.json"
    assert main([*words, "--add", "Cup=1", "--on", name, "--out", str(out)]) == 0
    assert json.loads(capsys.readouterr().out)["objects"][0]["support"] == name
    assert main([*words, "--add", "Cup=1", "--beside", "Nothing", "--out", str(tmp_path / "no.json")]) == 1
    assert "nothing in the scene is called 'Nothing'" in capsys.readouterr().err
    assert main(["generate", "--add", "Cup=1", "--on", name, "--out", str(tmp_path / "no.json")]) == 1
    assert "--on, --beside and --in need a --scene" in capsys.readouterr().err
    assert not (tmp_path / "no.json").exists()


def desk_of_parts() -> SceneGraph:
    """A floor, and a group without a mesh of its own whose parts are a top and two legs, as USD files have them."""
    builder = SceneBuilder("Office")
    builder.add("Floor", uid="floor", local=at(0, 0, -0.1), mesh=box("Floor", 5, 5, 0.1), category="Floor")
    desk = builder.add("Desk", uid="desk", local=at(0.5, 0.3, 0))
    builder.add("Top", uid="top", parent=desk, local=at(0, 0, 0.7), mesh=box("Top", 1.4, 0.7, 0.05))
    for side in (-0.6, 0.6):
        builder.add(
            f"Leg {side}", uid=f"leg {side}", parent=desk, local=at(side, 0, 0), mesh=box("Leg", 0.05, 0.6, 0.7)
        )
    builder.add("Nothing", uid="nothing", local=at(0, 0, 0))
    return builder.build()


def test_a_group_is_meant_as_a_whole(generator: Generator) -> None:
    scene = desk_of_parts()
    result = generator.add(scene, {"Cup": 2}, seed=1, on="Desk")
    assert result.added == 2
    assert {placement.support for placement in result.objects} == {"Desk"}
    np.testing.assert_allclose([world[2, 3] for world in world_matrices(result.scene)[result.rows]], 0.75, atol=1e-6)
    assert result.scene.category_name(result.scene.row_of_uid["desk"]) == ""  # only for the placing
    assert generator.add(scene, {"Cup": 1}, seed=1, beside="desk").added == 1


def test_an_empty_that_holds_nothing_is_no_group(generator: Generator) -> None:
    with pytest.raises(UniSGError, match="'Nothing' has neither a mesh nor a category"):
        generator.add(desk_of_parts(), {"Cup": 1}, seed=1, on="Nothing")

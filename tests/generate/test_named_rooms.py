"""Which kind each room is, how a room is found by it, and that things are placed there."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tests.generate.house import KITCHEN, LEFT, RIGHT, house
from tests.generate.test_foreign_rooms import check
from tests.spatial.built_rooms import SQUARE, box, room, scene
from unisg_blender.cli import main
from unisg_blender.errors import UniSGError
from unisg_blender.formats.scene_files import write_scene_file
from unisg_blender.generate import Generator
from unisg_blender.generate.observe.named_rooms import find_room, point_in_room, room_names
from unisg_blender.geometry.polygon import inside
from unisg_blender.pretrained import find_generator
from unisg_blender.scene import SceneBuilder, SceneGraph
from unisg_blender.scene.component_table import table
from unisg_blender.scene.components import COLLECTIONS
from unisg_blender.scene.structure_marks import ROOM_MARK, with_marks
from unisg_blender.spatial.structure import recognise_structure


@pytest.fixture(scope="module")
def generator() -> Generator:
    return Generator.load(find_generator("living_room"))


def kinds(graph: SceneGraph) -> dict[str, str]:
    """What the left and the right room are."""
    structure = recognise_structure(graph)
    found = {"left": "no room", "right": "no room"}
    for place, name in zip(structure.rooms, room_names(structure, graph), strict=True):
        found["left" if place.inner_point[0] < 5 else "right"] = name.label
    return found


def test_rooms_are_told_by_their_things() -> None:
    assert kinds(house()) == {"left": "kitchen", "right": "bedroom"}
    assert kinds(house(things={})) == {"left": "", "right": ""}


def test_a_room_that_two_kinds_share_is_both() -> None:
    lounge = {"Sofa": box((1, 0.2, 0), (3, 1.1, 0.8)), "TV": box((1, 3, 0.5), (2, 3.1, 1.1)),
              "coffee table": box((1, 2, 0), (2, 2.5, 0.4)), "Fridge": box((4, 3, 0), (4.7, 3.7, 1.9))}  # fmt: skip
    assert kinds(house(things=lounge))["left"] == "living room and kitchen"
    sleep = {"Bed": box((1, 1, 0), (3, 3, 0.5)), "Nightstand": box((3.2, 1, 0), (3.6, 1.4, 0.5)),
             "Sofa": box((1, 0.1, 0), (3, 0.9, 0.8))}  # fmt: skip
    assert kinds(house(things=sleep))["left"] == "bedroom"


def test_names_of_floors_and_collections_count_before_things() -> None:
    graph = house(("Küchenboden", "FLR_Office_01"))
    assert kinds(graph) == {"left": "kitchen", "right": "office"}
    rows = [graph.row_of_uid[uid] for uid in KITCHEN]
    listed = graph.with_component(COLLECTIONS, table(rows, path=[("House", "Garage")] * len(rows)))
    assert kinds(listed) == {"left": "garage", "right": "office"}


def test_what_the_user_marked_counts_first() -> None:
    graph = house(("Kitchen Floor", "Bedroom Floor"))
    marked = with_marks(
        graph, ROOM_MARK, {graph.row_of_uid["Kitchen Floor"]: "Waiting Room", graph.row_of_uid["wardrobe"]: "None"}
    )
    assert kinds(marked) == {"left": "waiting room", "right": "no room"}
    assert recognise_structure(marked).room_at(np.array([7.0, 1.0, 0.5])) == -1


def test_a_room_is_found_by_what_it_is() -> None:
    graph = house()
    rooms = recognise_structure(graph).rooms
    for words in ("kitchen", "the kitchen", "Küche", "キッチン"):
        assert inside(LEFT, rooms[find_room(graph, words)].inner_point)
    assert inside(RIGHT, rooms[find_room(graph, "Bedrooms")].inner_point)
    assert find_room(graph, " 1 ") == 1


@pytest.mark.parametrize(
    ("graph", "text", "said"),
    [
        (house(), "bathroom", "no room of the scene is 'bathroom': there is 0: .* 1: .*kitchen|bedroom"),
        (house(), "kitchn", "did you mean 'kitchen'"),
        (house(), "2", "no room of the scene is '2'"),
        (house(), "", "no room of the scene is ''"),
        (house(things=KITCHEN | {"Fridge": box((6, 3, 0), (6.7, 3.7, 1.9))}), "kitchen", "2 rooms are 'kitchen': 0: "),
        (SceneBuilder("Empty").build(), "kitchen", "no room was found in the scene"),
    ],
)  # fmt: skip
def test_a_room_that_is_not_one_is_told(graph: SceneGraph, text: str, said: str) -> None:
    with pytest.raises(UniSGError, match=said):
        find_room(graph, text)


@pytest.mark.parametrize(
    "graph",
    [house(), house(("Floor", "Floor.001")), house(("Floor", "Floor.001"), category="Floor")],
    ids=["one floor", "two floors", "with categories"],
)
@pytest.mark.parametrize(("kind", "outline"), [("kitchen", LEFT), ("bedroom", RIGHT)])
def test_things_are_placed_in_the_room_that_is_meant(generator, graph, kind, outline) -> None:
    made = generator.add(graph, {"Chair": 2, "Plant": 1}, seed=3, within=kind, behaviour=False)
    check(made, outline, 0.0, least=3)


def test_things_of_other_rooms_hold_nothing(generator) -> None:
    """The only table is in the other room: nothing is put onto it."""
    things = KITCHEN | {"Dining Table": box((6, 1, 0), (7.4, 1.9, 0.75)), "Bed": box((8, 1, 0), (9.5, 3, 0.5))}
    made = generator.add(house(things=things), {"Vase": 2}, seed=1, within="kitchen", behaviour=False)
    for item in made.objects:
        assert item.refused or inside(LEFT, item.world[:2, 3])


def test_a_house_of_one_room_needs_no_point() -> None:
    graph = scene(room(SQUARE, 0.1) | {name: part for name, part in KITCHEN.items()})
    assert point_in_room(graph, "kitchen") is None


def test_a_room_and_an_object_are_not_both_taken(generator) -> None:
    with pytest.raises(UniSGError, match="either a room, or an object"):
        generator.add(house(), {"Chair": 1}, within="kitchen", on="Doppelbett")


def test_the_command_line_places_in_a_room_and_shows_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, out = tmp_path / "house.json", tmp_path / "out.json"
    write_scene_file(house(), file)
    words = [
        "generate",
        "--model",
        "living_room",
        "--scene",
        str(file),
        "--add",
        "Chair=1",
        "--json",
        "--out",
        str(out),
    ]
    assert main([*words, "--in", "bedroom"]) == 0
    (item,) = json.loads(capsys.readouterr().out)["objects"]
    assert inside(RIGHT, np.array([item["world"][0][3], item["world"][1][3]]))
    assert main([*words, "--in", "cellar"]) == 1
    assert "no room of the scene is 'cellar'" in capsys.readouterr().err
    assert main(["inspect", str(file), "--structure"]) == 0
    assert "kitchen (by its Cooker, Refrigerator and Sink)" in capsys.readouterr().out
    assert main(["inspect", str(file), "--structure", "--json"]) == 0
    assert sorted(place["kind"] for place in json.loads(capsys.readouterr().out)["rooms"]) == ["bedroom", "kitchen"]

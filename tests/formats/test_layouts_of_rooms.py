"""sceneState in and out, Habitat, SAGE, 3D-FRONT and SSR: where things are in our axes, told by hand."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.formats.reading import bounds, found_in, relations, write, xyz
from unisg_blender.cli import main
from unisg_blender.errors import UniSGError
from unisg_blender.formats.scene_files import read_scene_file, write_scene_file
from unisg_blender.worlds import WORLDS

HALF = np.sqrt(0.5)
WEDGE = "".join(f"v {x} {y} {z}\n" for x in (0, 1) for y in (0, 2) for z in (0, 3)) + "f 1 2 4 3\nf 5 7 8 6\n"
"""A box with y up, from the origin: 1 m wide, 2 m high, 3 m towards +z."""


def scene_state() -> dict[str, Any]:
    """A wall along y with a window, and a model turned by a quarter about the axis that is up."""
    hole = {"type": "Window", "box": {"min": [1, 0.8], "max": [2, 2]}}
    wall = {"id": "w", "type": "Wall", "height": 2.8, "depth": 0.1, "points": [[0, 0, 0], [0, 6, 0]], "holes": [hole]}
    floor = {"id": "f", "type": "Floor", "roomId": "bedroom", "points": [[0, 0, 0], [0, 6, 0], [4, 6, 0], [4, 0, 0]]}
    columns = [[0, 1, 0, 0], [0, 0, 1, 0], [1, 0, 0, 0], [2, 3, 0.5, 1]]  # its x along y, its y up, its z along x
    model = {
        "id": "1",
        "index": 0,
        "modelId": "some.wedge",
        "transform": {"data": [number for column in columns for number in column]},
    }
    lamp = {**model, "id": "2", "index": 1, "modelId": "some.lamp", "parentId": "1"}
    return {"format": "sceneState", "scene": {"arch": {"elements": [wall, floor]}, "object": [model, lamp]}}


def test_a_scene_state_is_read_with_its_models(tmp_path: Path) -> None:
    write(tmp_path / "models" / "some.wedge.obj", WEDGE)
    write(tmp_path / "models" / "some.wedge" / "data.json", {"annotations": {"category": "bed"}})
    (found,) = found_in(write(tmp_path / "scene.json", scene_state()), tmp_path / "models")
    graph = found.graph
    np.testing.assert_allclose(bounds(graph, "bed"), [[2, 3, 0.5], [5, 4, 2.5]], atol=1e-6)
    np.testing.assert_allclose(bounds(graph, "Wall"), [[-0.05, 0, 0], [0.05, 6, 2.8]], atol=1e-6)
    np.testing.assert_allclose(bounds(graph, "Window"), [[-0.075, 1, 0.8], [0.075, 2, 2]], atol=1e-6)
    np.testing.assert_allclose(bounds(graph, "Floor"), [[0, 0, -0.05], [4, 6, 0]], atol=1e-6)
    assert relations(graph) == {("Object", "on_top_of", "bed")}
    assert "some.lamp: its model is not there: it is a place without a shape (--assets FOLDER)" in list(found.report)


def test_a_room_comes_back_from_its_scene_state(tmp_path: Path) -> None:
    room = WORLDS["living-room"](5)
    path = tmp_path / "room.scenestate.json"
    report = write_scene_file(room, path)
    again, lost = read_scene_file(path)
    assert not list(lost)
    assert "actions are not part of a sceneState" in list(report)
    for row in range(len(again)):
        category = again.category_name(row)
        if category in ("Wall", "Door", "Window", "Floor", "Ceiling"):
            continue
        where = [
            bounds_of_parts(room, other) for other in range(len(room)) if room.category_name(other) == category
        ]  # fmt: skip
        gaps = [np.abs(bounds(again, again.name[row]) - each).max() for each in where]
        assert min(gaps) < 1e-5, category
    for category in ("Wall", "Door", "Window"):
        ours = [bounds_of_parts(room, row)[:, :2] for row in range(len(room)) if room.category_name(row) == category]
        theirs = [bounds(again, name) for name, row in zip(again.name, range(len(again)), strict=True)
                  if again.category_name(row) == category]  # fmt: skip
        assert len(ours) == len(theirs) > 0
    kinds = {kind for _, kind, _ in relations(again)}
    assert kinds == {"on_top_of"}
    with pytest.raises(UniSGError, match="does not exist"):
        write_scene_file(room, tmp_path / "nowhere" / "room.scenestate.json")


def bounds_of_parts(graph: Any, row: int) -> np.ndarray:
    """Lowest and highest corner of an entity with the parts below it that have no category."""
    own = {row}
    for other in range(row + 1, len(graph)):
        if graph.parent[other] in own and graph.category[other] < 0:
            own.add(other)
    boxes = [
        bounds(graph.replace(name=tuple(map(str, range(len(graph))))), str(part))
        for part in own
        if graph.mesh[part] >= 0
    ]
    return np.array([np.min([low for low, _ in boxes], axis=0), np.max([high for _, high in boxes], axis=0)])


def habitat(folder: Path, **scene: Any) -> Path:
    """A data set with a stage and one template; the scene turns the template by a quarter about y, and doubles it."""
    write(folder / "set.scene_dataset_config.json", {})
    write(folder / "stages" / "hall.obj", WEDGE)
    write(
        folder / "stages" / "hall.stage_config.json", {"render_asset": "hall.obj", "up": [0, 1, 0], "front": [0, 0, -1]}
    )
    write(folder / "objects" / "a1.obj", WEDGE)
    write(folder / "objects" / "a1.object_config.json", {"render_asset": "a1.obj"})
    write(folder / "semantics" / "objects.csv", "id,name,main_category\na1,wedge,wardrobe\n")
    item = {
        "template_name": "objects/a1",
        "translation": [10, 0, 20],
        "rotation": [HALF, 0, HALF, 0],
        "uniform_scale": 2,
    }
    record = {"stage_instance": {"template_name": "stages/hall"}, "object_instances": [item]} | scene
    return write(folder / "scenes" / "one.scene_instance.json", record)


def test_objects_of_habitat_stand_where_their_own_origin_is_told(tmp_path: Path) -> None:
    (found,) = found_in(habitat(tmp_path, translation_origin="asset_local"))
    graph = found.graph
    # in its axes x 10..16, y 0..4, z 18..20 (its z turned to x, its x to -z); here y is -z, z is y
    np.testing.assert_allclose(bounds(graph, "wardrobe"), [[10, -20, 0], [16, -18, 4]], atol=1e-5)
    stage = [name for name in graph.name if graph[name].parent is not None]
    np.testing.assert_allclose(bounds(graph, stage[0]), [[0, -3, 0], [1, 0, 2]], atol=1e-6)


def test_templates_that_the_description_of_a_habitat_set_makes(tmp_path: Path) -> None:
    """One changes the file of another, one names a mesh itself; the licence is not guessed."""
    path = habitat(tmp_path, translation_origin="asset_local", stage_instance={"template_name": "great_hall"})
    halls = [{"original_file": "stages/hall.stage_config.json", "template_handle": "great_hall",
              "attributes": {"scale": [2, 2, 2]}}]  # fmt: skip
    chests = [{"template_handle": "a1", "attributes": {"render_asset": "stages/hall.obj", "scale": [3, 1, 1]}}]
    write(tmp_path / "set.scene_dataset_config.json", {"stages": {"configs": halls}, "objects": {"configs": chests}})
    (found,) = found_in(path)
    stage = [name for name in found.graph.name if found.graph[name].parent is not None]
    np.testing.assert_allclose(bounds(found.graph, stage[0]), [[0, -6, 0], [2, 0, 4]], atol=1e-6)
    np.testing.assert_allclose(np.ptp(bounds(found.graph, "wardrobe"), axis=0), [6, 6, 4], atol=1e-5)
    assert found.reader.LICENCE == ""


def test_objects_of_habitat_stand_where_their_middle_is_told(tmp_path: Path) -> None:
    (found,) = found_in(habitat(tmp_path))
    np.testing.assert_allclose(bounds(found.graph, "wardrobe").mean(axis=0), [10, -20, 0], atol=1e-5)
    assert found.graph["wardrobe"].category == "wardrobe"
    (tmp_path / "objects" / "a1.obj").unlink()
    (bare,) = found_in(habitat(tmp_path / "b").rename(tmp_path / "b" / "scenes" / "two.json"))
    assert bare.graph["wardrobe"].mesh is not None


def sage() -> dict[str, Any]:
    """A room away from the origin: a table turned by 90 degrees, a cup on it, a picture on the wall."""
    wall = {"id": "w1", "start_point": xyz(2, 1, 0), "end_point": xyz(6, 1, 0), "height": 2.7, "thickness": 0.1}
    door = {"id": "d1", "wall_id": "w1", "position_on_wall": 0.25, "width": 0.8, "height": 2}
    window = {"id": "n1", "wall_id": "w1", "position_on_wall": 0.75, "width": 1, "height": 1, "sill_height": 0.9}

    def thing(uid: str, kind: str, place: str, at: tuple[float, float, float], size: tuple[float, float, float]) -> Any:
        dimensions = dict(zip(("width", "length", "height"), size, strict=True))
        base = {"id": uid, "type": kind, "place_id": place, "position": xyz(*at), "rotation": xyz(0, 0, 90)}
        return base | {"dimensions": dimensions, "source": "objaverse", "source_id": "s1", "mass": 2.5}

    objects = [
        thing("t", "table", "floor", (4, 3, 0), (2, 1, 0.7)), thing("c", "cup", "t", (4, 3.5, 0.7), (0.1, 0.1, 0.1)),
        thing("p", "picture", "w1", (3, 1.1, 1.5), (0.5, 0.1, 0.4)),
    ]  # fmt: skip
    room = {"id": "r", "room_type": "dining room", "position": xyz(2, 1, 0), "walls": [wall], "doors": [door]}
    room |= {"dimensions": {"width": 4, "length": 5, "height": 2.7}, "windows": [window], "objects": objects}
    return {"id": "plan", "rooms": [room]}


def test_rooms_of_sage_say_what_stands_on_what(tmp_path: Path) -> None:
    (found,) = found_in(write(tmp_path / "plan.json", sage()))
    graph = found.graph
    np.testing.assert_allclose(bounds(graph, "table"), [[3.5, 2, 0], [4.5, 4, 0.7]], atol=1e-6)
    np.testing.assert_allclose(bounds(graph, "Floor"), [[2, 1, -0.1], [6, 6, 0]], atol=1e-6)
    np.testing.assert_allclose(bounds(graph, "Door"), [[2.6, 0.925, 0], [3.4, 1.075, 2]], atol=1e-6)
    np.testing.assert_allclose(bounds(graph, "Window"), [[4.5, 0.925, 0.9], [5.5, 1.075, 1.9]], atol=1e-6)
    said = {("table", "on_top_of", "Floor"), ("cup", "on_top_of", "table"), ("picture", "hangs_from", "Wall")}
    assert relations(graph) == said
    ((text),) = [text for row, text in graph.entries("properties", "json") if graph.name[row] == "cup"]
    assert json.loads(text) == {"asset": "s1", "mass": 2.5}


def front3d() -> dict[str, Any]:
    """A floor within the file, and a sofa turned by a quarter about y, twice as wide as its model."""
    floor = {"uid": "m1", "type": "Floor", "xyz": [0, 0, 0, 4, 0, 0, 4, 0, 5, 0, 0, 5], "faces": [0, 2, 1, 0, 3, 2]}
    sofa = {"uid": "f1", "jid": "j1", "category": "Sofa/Lazy Sofa", "size": [2, 0.8, 1]}
    still = {"pos": [0, 0, 0], "rot": [0, 0, 0, 1], "scale": [1, 1, 1]}
    children = [
        {"ref": "m1", "instanceid": "a", **still},
        {"ref": "f1", "instanceid": "b", "pos": [2, 0, 1], "rot": [0, HALF, 0, HALF], "scale": [2, 1, 1]},
        {"ref": "nothing", "instanceid": "c", **still},
    ]
    room = {"type": "LivingRoom", "instanceid": "LivingRoom-1", "children": children}
    return {"uid": "u", "furniture": [sofa], "mesh": [floor], "scene": {"room": [room]}}


def test_houses_of_3d_front_are_right_handed(tmp_path: Path) -> None:
    (found,) = found_in(write(tmp_path / "house.json", front3d()))
    graph = found.graph
    np.testing.assert_allclose(bounds(graph, "Floor"), [[0, -5, 0], [4, 0, 0]], atol=1e-6)
    # 4 m wide, which now lies along z there, -y here
    np.testing.assert_allclose(bounds(graph, "Lazy Sofa"), [[1.5, -3, 0], [2.5, 1, 0.8]], atol=1e-6)
    assert graph["Floor"].category == "Floor"
    write(tmp_path / "future" / "j1" / "raw_model.obj", WEDGE)
    (dressed,) = found_in(tmp_path / "house.json", tmp_path / "future")
    # the mesh 2 m wide now, 3 m towards its +z, which lies along +x; its x lies along -z there, +y here
    np.testing.assert_allclose(bounds(dressed.graph, "Lazy Sofa"), [[2, -1, 0], [5, 1, 2]], atol=1e-6)


def test_rooms_of_respace_have_their_outline_as_walls(tmp_path: Path) -> None:
    low = [[-1, 0, 2], [1, 0, 2], [1, 0, -2], [-1, 0, -2]]
    item = {"desc": "A wide bed, of oak.", "size": [1, 0.5, 2], "pos": [0, 0, 1], "rot": [0, HALF, 0, HALF]}
    room = {"room_type": "bedroom", "bounds_bottom": low, "bounds_top": [[x, 2.6, z] for x, _, z in low]}
    (found,) = found_in(write(tmp_path / "room.json", room | {"objects": [item, {**item, "rot": [0, 0, 0, 0]}]}))
    graph = found.graph
    np.testing.assert_allclose(bounds(graph, "A wide bed"), [[-1, -1.5, 0], [1, -0.5, 0.5]], atol=1e-6)
    np.testing.assert_allclose(bounds(graph, "A wide bed.001"), [[-0.5, -2, 0], [0.5, 0, 0.5]], atol=1e-6)
    np.testing.assert_allclose(bounds(graph, "Floor"), [[-1, -2, -0.1], [1, 2, 0]], atol=1e-6)
    walls = np.array([bounds(graph, name) for name in graph.name if name.startswith("Wall")])
    np.testing.assert_allclose(walls[:, 1, 2], 2.6)
    assert walls[:, 0, 0].min() == pytest.approx(-1.04)  # outside the outline
    assert len(walls) == 4


DAMAGES: dict[str, Any] = {
    "arch": lambda: scene_state() | {"scene": {"object": [{"transform": {}}]}},
    "matrix": lambda: scene_state() | {"scene": {"object": [{"id": "1", "transform": {"data": [1] * 15}}]}},
    "front": lambda: front3d() | {"mesh": [{"uid": "m1", "xyz": [0, 0, 0], "faces": [0, 1, 2]}]},
    "sage": lambda: {"rooms": [{**sage()["rooms"][0], "objects": [{"id": 1}]}]},
    "ssr": lambda: {"bounds_top": [], "bounds_bottom": [], "objects": []},
    "habitat": lambda: {"object_instances": [{"template_name": "a", "rotation": [0, 0, 0, 0]}]},
}


@pytest.mark.parametrize("name", DAMAGES)
def test_damaged_rooms_are_one_line(tmp_path: Path, name: str, capsys: pytest.CaptureFixture[str]) -> None:
    path = write(tmp_path / "room.json", DAMAGES[name]())
    assert main(["inspect", str(path)]) == 1
    told = capsys.readouterr().err.splitlines()
    assert len(told) == 1
    assert str(path) in told[0]

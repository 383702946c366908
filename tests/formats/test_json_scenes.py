"""A scene as JSON is the scene: what is read back is what was written, and what cannot be read is told in one line."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given, settings

from tests.usd.compare import assert_same_graph
from tests.usd.random_scenes import scenes
from unisg_blender.cli import main
from unisg_blender.errors import UniSGError
from unisg_blender.formats.json_scenes import KEY, read_json, write_json
from unisg_blender.formats.scene_files import read_scene_file, write_scene_file
from unisg_blender.scene import SceneGraph, table
from unisg_blender.worlds import WORLDS


def through_file(graph: SceneGraph) -> SceneGraph:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "scene.json")
        write_json(graph, path)
        return read_json(path)


def assert_identical(first: SceneGraph, second: SceneGraph) -> None:
    """The same to the last bit, materials, types of numbers and the order of meshes included."""
    assert_same_graph(first, second)
    for column in ("type", "parent", "category", "local", "mesh"):
        found, expected = getattr(second, column), getattr(first, column)
        assert (found.dtype, found.tobytes()) == (expected.dtype, expected.tobytes()), column
    assert [mesh.checksum for mesh in second.meshes] == [mesh.checksum for mesh in first.meshes]
    assert second.materials == first.materials
    assert second.frames == first.frames
    for name, component in first.components.items():
        for key, column in component.columns.items():
            assert second.components[name].columns[key].dtype == column.dtype, (name, key)


@pytest.mark.slow
@pytest.mark.parametrize("world", ["operating-room", "living-room", "cubes"])
@settings(max_examples=5, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_worlds_come_back_to_the_last_bit(world: str, seed: int) -> None:
    graph = WORLDS[world](seed)
    assert_identical(graph, through_file(graph))


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(scenes())
def test_hard_scenes_come_back_to_the_last_bit(graph: SceneGraph) -> None:
    assert_identical(graph, through_file(graph))


def test_instances_share_prototypes_and_meshes() -> None:
    inner = WORLDS["cubes"](1)
    middle = inner.replace(title="middle").with_component(
        "instances", table([0], prototype=[inner], matrix=np.eye(4)[None], source=["GEOMETRY"])
    )
    outer = inner.with_component(
        "instances",
        table(
            [1, 1, 2], prototype=[middle, middle, inner], matrix=np.stack([np.eye(4)] * 3), source=["COLLECTION"] * 3
        ),
    )
    found = through_file(outer)
    assert_identical(outer, found)
    first, second, third = found.components["instances"].columns["prototype"]
    assert first is second
    assert first.components["instances"].columns["prototype"][0] is third
    assert third.meshes[0] is found.meshes[0]


def record_of(tmp_path: Path) -> dict:
    write_json(WORLDS["cubes"](0), tmp_path / "whole.json")
    return json.loads((tmp_path / "whole.json").read_text())


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda record: record.pop(KEY), "no scene with its geometry"),
        (lambda record: record.update({KEY: 99}), "update it"),
        (lambda record: record.update({KEY: "one"}), "update it"),
        (lambda record: record["entities"][3].pop("uid"), "damaged"),
        (lambda record: record["entities"][3].update(parent="nobody"), "damaged"),
        (lambda record: record["entities"][0].update(parent=record["entities"][3]["uid"]), "damaged"),
        (lambda record: record["entities"][3].update(uid=record["entities"][0]["uid"]), "damaged"),
        (lambda record: record["entities"][3].update(local=[[1.0]]), "damaged"),
        (lambda record: record["entities"][3].update(mesh=1000), "damaged"),
        (lambda record: record["meshes"][0]["corners"].append(-1), "damaged"),
        (lambda record: record["meshes"][0]["offsets"].insert(1, 9), "damaged"),
        (lambda record: record["meshes"][0].update(normals=[[0.0, 0.0, 1.0]]), "damaged"),
        (lambda record: record["meshes"][0].update(material_index=[0]), "damaged"),
        (lambda record: record["components"]["relations"]["rows"].append(1), "damaged"),
        (
            lambda record: record["components"]["relations"]["columns"]["kind"]["values"].insert(0, {"odd": 1}),
            "damaged",
        ),
        (lambda record: record.update(prototypes=[{}]), "damaged"),
    ],
)
def test_what_is_no_whole_scene_is_told(tmp_path: Path, change: object, reason: str) -> None:
    record = record_of(tmp_path)
    change(record)  # type: ignore[operator]
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(record))
    with pytest.raises(UniSGError, match=reason) as told:
        read_scene_file(path)
    assert "\n" not in str(told.value)


def test_a_slot_that_is_not_there_is_the_last_one(tmp_path: Path) -> None:
    record = record_of(tmp_path)
    faces = len(record["meshes"][0]["offsets"]) - 1
    record["meshes"][0] |= {"materials": ["Red", "Blue"], "material_index": [5, -1, *[1] * (faces - 2)]}
    (tmp_path / "scene.json").write_text(json.dumps(record))
    mesh = read_json(tmp_path / "scene.json").meshes[0]
    assert mesh.material_index is not None
    assert mesh.material_index.tolist() == [1, 0, *[1] * (faces - 2)]


@pytest.mark.parametrize("text", ["", "{", "[]", "7", "[" * 10_000, "\xff"])
def test_other_text_is_told(tmp_path: Path, text: str) -> None:
    path = tmp_path / "scene.json"
    path.write_bytes(text.encode("latin-1"))
    with pytest.raises(UniSGError, match="cannot read"):
        read_json(path)


def test_values_without_a_json_form_are_told(tmp_path: Path) -> None:
    graph = WORLDS["cubes"](0).with_component("own", table([0], data=[{1, 2}]))
    with pytest.raises(UniSGError, match=r"own\.data"):
        write_json(graph, tmp_path / "scene.json")
    assert list(tmp_path.iterdir()) == []


def test_verbs_read_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    graph = WORLDS["operating-room"](3)
    for name in ("room.json", "room.usda"):
        write_scene_file(graph, tmp_path / name)
    told = []
    for name in ("room.json", "room.usda"):
        assert main(["inspect", str(tmp_path / name), "--json"]) == 0
        told.append({**json.loads(capsys.readouterr().out), "file": ""})
    assert told[0]["components"] == told[1]["components"]
    assert [entity["uid"] for entity in told[0]["records"]] == [entity["uid"] for entity in told[1]["records"]]
    assert main(["convert", str(tmp_path / "room.json"), str(tmp_path / "again.json"), "-q"]) == 0
    assert (tmp_path / "again.json").read_bytes() == (tmp_path / "room.json").read_bytes()


@pytest.mark.parametrize("ending", ["json", "usda", "blend", "glb"])
def test_a_file_name_that_is_too_long_is_one_line(ending: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["inspect", f"{'x' * 300}.{ending}"]) == 1
    told = capsys.readouterr().err.splitlines()
    assert len(told) == 1
    assert told[0].endswith("File name too long")


def test_a_path_may_be_text(tmp_path):
    path = str(tmp_path / "scene.json")
    graph = WORLDS["cubes"](1)
    write_scene_file(graph, path)
    assert_same_graph(read_scene_file(path)[0], graph)

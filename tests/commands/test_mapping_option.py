"""``--mapping`` gives categories wherever a verb reads a scene, and ``label`` takes several files."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.meshes.shapes import box
from unisg_blender.formats import read_scene_file, write_scene_file
from unisg_blender.scene import SceneBuilder, SceneGraph

Run = Callable[..., tuple[str, str]]


def room() -> SceneGraph:
    builder = SceneBuilder("room")
    builder.add("Ground", uid="g", mesh=box((6, 6, 0.1), (-3, -3, -0.1)))
    builder.add("Couch", uid="c", mesh=box((2, 0.9, 0.8)))
    return builder.build()


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    write_scene_file(room(), tmp_path / "room.json")
    (tmp_path / "names.toml").write_text('[objects]\n"Ground" = "Floor"\n')
    return tmp_path / "room.json"


def categories(path: Path) -> dict[str, str]:
    graph, _ = read_scene_file(path)
    return {name: graph.category_name(row) for row, name in enumerate(graph.name)}


def test_inspect_and_convert(scene: Path, run: Run) -> None:
    mapping = scene.parent / "names.toml"
    assert json.loads(run("inspect", scene, "--json", "--mapping", mapping)[0])["categories"] == {"Floor": 1}
    run("convert", scene, scene.parent / "out.json", "--mapping", mapping)
    assert categories(scene.parent / "out.json") == {"Ground": "Floor", "Couch": ""}


def test_generate_adds_to_the_floor_that_the_mapping_names(scene: Path, run: Run) -> None:
    out = scene.parent / "out.json"
    words = ("generate", "--scene", scene, "--add", "Monitor=1", "--seed", 1, "--out", out, "--json")
    report = json.loads(run(*words, "--mapping", scene.parent / "names.toml")[0])
    assert report["added"] == 1
    assert categories(out)["Ground"] == "Floor"


@pytest.mark.parametrize("words", [("classify",), ("label",), ("relations",), ("simulate", "--rehearse"), ("inspect",)])
def test_a_mapping_that_is_not_there_is_refused_by_every_verb(scene: Path, run: Run, words: tuple[str, ...]) -> None:
    assert "cannot read the mapping none.toml" in run(*words, scene, "--mapping", "none.toml", status=1)[1]


def test_label_leaves_mapped_objects_alone_and_writes_their_categories(scene: Path, run: Run) -> None:
    out = scene.parent / "out.json"
    words = ("label", scene, "--mapping", scene.parent / "names.toml", "--threshold", 0, "--out", out, "--json")
    (report,) = json.loads(run(*words)[0])["files"]
    assert [proposal["name"] for proposal in report["proposals"]] == ["Couch"]
    assert categories(out)["Ground"] == "Floor"
    assert categories(out)["Couch"]


def test_label_takes_several_files_and_one_that_fails_costs_itself(scene: Path, run: Run) -> None:
    second, bad, out = scene.parent / "second.json", scene.parent / "bad.json", scene.parent / "out"
    write_scene_file(room(), second)
    bad.write_text("{")
    text, err = run("label", scene, bad, second, "--threshold", 0, "--out", out, status=3)
    assert [line for line in text.splitlines() if line.endswith(".json:")] == [f"{scene}:", f"{second}:"]
    assert "bad.json" in err
    assert len(err.splitlines()) == 1
    assert sorted(path.name for path in out.iterdir()) == ["room.json", "second.json"]


def test_label_refuses_targets_that_would_meet(scene: Path, run: Run) -> None:
    other = scene.parent / "other" / "room.json"
    other.parent.mkdir()
    write_scene_file(room(), other)
    assert "2 of the files are called room.json" in run("label", scene, other, "--out", "x", status=1)[1]
    second = scene.parent / "second.json"
    write_scene_file(room(), second)
    assert "folder of the files themselves" in run("label", scene, second, "--out", scene.parent, status=1)[1]
    assert not Path("x").exists()

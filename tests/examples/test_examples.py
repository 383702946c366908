"""Each script of examples/ does what it says, on small input."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from architecture import ROOT

from unisg_blender import ActionData, LessonNode, SceneBuilder, open_dataset, read_scene_file, write_scene_file
from unisg_blender.behaviour import load_types, moments, prepare, rehearse, remove_type, simulate
from unisg_blender.dataset import write_dataset
from unisg_blender.scene import Thresholds
from unisg_blender.worlds import living_room

EXAMPLES = ROOT / "examples"
TRIED = {
    "batch_in_background", "copied_rooms", "dask_farm", "fewer_keys", "lesson_report", "own_action_type",
    "own_category", "own_metric", "own_network", "own_reader", "own_world",
}  # fmt: skip


def printed(name: str, *words: object) -> str:
    """What a script prints; it must end well."""
    done = ran(name, *words)
    assert done.returncode == 0, done.stderr
    return done.stdout


def ran(name: str, *words: object, **environment: str) -> subprocess.CompletedProcess[str]:
    """A script after its end."""
    command = [sys.executable, str(EXAMPLES / f"{name}.py"), *map(str, words)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1", **environment}
    return subprocess.run(command, capture_output=True, text=True, timeout=200, env=environment)


@pytest.fixture(scope="module")
def homes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a living room as a .blend file."""
    folder = tmp_path_factory.mktemp("homes")
    write_scene_file(living_room(3), folder / "home.blend")
    return folder


def test_every_script_is_tried() -> None:
    assert {path.stem for path in EXAMPLES.glob("*.py")} == TRIED


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.stem)
def test_scripts_are_short_and_on_the_page_of_examples(path: Path) -> None:
    assert 10 <= len(path.read_text("utf-8").splitlines()) <= 40
    assert f"examples/{path.name}" in (ROOT / "docs" / "guide" / "examples.md").read_text("utf-8")


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(TRIED - {"fewer_keys", "own_action_type"}))
def test_a_script_without_words_says_how_it_is_used(name: str) -> None:
    done = ran(name)
    assert done.returncode == 1
    assert done.stdout == ""
    assert f"python examples/{name}.py" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("batch_in_background", ("absent", "out", "Cup=2")),
        ("copied_rooms", ("absent", "out", "2", "10")),
        ("lesson_report", ("absent",)),
        ("own_category", ("absent.blend", "out.blend")),
        ("own_category", ("absent", "out.blend")),
        ("own_metric", ("absent",)),
        ("own_network", ("absent",)),
        ("own_reader", ("absent.csv", "out.blend")),
    ],
)
def test_what_is_not_there_is_said_in_one_line(
    name: str, words: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    done = ran(name, *words)
    assert done.returncode == 1
    assert done.stdout == ""
    assert done.stderr.count("\n") == 1
    assert words[0] in done.stderr
    assert not list(tmp_path.iterdir())


def test_a_farm_says_what_it_needs(tmp_path: Path) -> None:
    (tmp_path / "distributed.py").write_text("raise ImportError", "utf-8")
    done = ran("dask_farm", "out", "2", PYTHONPATH=os.pathsep.join([str(tmp_path), str(ROOT)]))
    assert done.returncode == 1
    assert "[cluster]" in done.stderr
    assert done.stderr.count("\n") == 1


@pytest.mark.slow
def test_things_are_added_to_files(homes: Path, tmp_path: Path) -> None:
    assert "home.blend: 2 added" in printed("batch_in_background", homes, tmp_path / "out", "Cup=2")
    assert len(read_scene_file(tmp_path / "out" / "home.blend")[0]) == len(read_scene_file(homes / "home.blend")[0]) + 2


@pytest.mark.slow
def test_a_network_learns_categories(tmp_path: Path) -> None:
    write_dataset([living_room(seed) for seed in range(10)], tmp_path / "rooms", "sixd")
    assert int(printed("own_network", tmp_path / "rooms").partition("%")[0]) > 50


@pytest.mark.slow
def test_a_rule_gives_categories(tmp_path: Path) -> None:
    room = tmp_path / "boxes.csv"
    table = "name,category,x,y,z,width,depth,height,degrees\nTable,Table,0,0,0,120,80,70,0\n"
    room.write_text(table + "Cup,Cup,20,0,70,8,8,10,30\n", "utf-8")
    assert "2 entities: Cup, Table" in printed("own_reader", room, tmp_path / "room.blend")
    scene, _ = read_scene_file(tmp_path / "room.blend")
    assert scene["Table"].category == "Table"
    assert scene["Cup"].world[2, 3] == pytest.approx(0.7)
    room.write_text(table + "Stool.001,,90,0,0,40,40,45,0\nnovel,Book,20,0,70,20,15,2,30\n", "utf-8")
    printed("own_reader", room, tmp_path / "room.usda")
    said = printed("own_category", tmp_path / "room.usda", tmp_path / "labelled.usda")
    assert "Stool 1" in said
    assert "Magazine 1" in said
    labelled, _ = read_scene_file(tmp_path / "labelled.usda")
    assert [labelled[name].category for name in ("Stool.001", "novel", "Table")] == ["Stool", "Magazine", "Table"]


@pytest.mark.slow
def test_a_rule_finds_something_in_a_room_of_the_guide(homes: Path, tmp_path: Path) -> None:
    assert "Magazine" in printed("own_category", homes / "home.blend", tmp_path / "labelled.blend")


@pytest.mark.slow
def test_a_metric_and_a_report_of_a_folder(homes: Path) -> None:
    assert "chairs in 1 rooms: median" in printed("own_metric", homes)
    assert "home.blend,True," in printed("lesson_report", homes)


@pytest.mark.slow
def test_a_world_and_a_generator_make_scenes(tmp_path: Path) -> None:
    assert "5 scenes" in printed("own_world", tmp_path / "shelves", 5)
    assert len(open_dataset(tmp_path / "shelves")) == 5
    printed("copied_rooms", tmp_path / "shelves", tmp_path / "copied", 2, 10)
    assert len(list((tmp_path / "copied").glob("*.usdc"))) == 2


@pytest.mark.slow
def test_a_farm_makes_rooms(tmp_path: Path) -> None:
    assert "3 rooms with" in printed("dask_farm", tmp_path / "out", 3)
    assert len(open_dataset(tmp_path / "out")) == 3


def test_a_door_needs_few_keys() -> None:
    keys, _, _, frames, *_ = printed("fewer_keys").split()
    assert int(keys) < int(frames) / 5


def test_an_own_action_type_is_played() -> None:
    load_types(EXAMPLES / "own_action_type.py")
    lift = ActionData("up", "Lift", "Lift it", ("cup",), thresholds=Thresholds(distance=1.0, hold=0.5))
    leaf = LessonNode("action", "leaf", action="up")
    tree = LessonNode("stage", "stage", children=(leaf,))
    tree = LessonNode("operation", "all", children=(LessonNode("lesson", "lesson", children=(tree,)),))
    builder = SceneBuilder()
    builder.add("Operation", uid="operation", lsa=tree)
    builder.add("Cup", uid="cup", actions=(lift,))
    lesson = prepare(scene := builder.build())
    finished = simulate(lesson, moments(scene, rehearse(lesson))).finished
    remove_type("Lift")
    assert finished

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
    command = [sys.executable, str(EXAMPLES / f"{name}.py"), *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=200, env=_environment())
    assert done.returncode == 0, done.stderr
    return done.stdout


def _environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"}


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
    assert len(path.read_text("utf-8").splitlines()) <= 60
    assert f"examples/{path.name}" in (ROOT / "docs" / "guide" / "examples.md").read_text("utf-8")


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
    room.write_text(table + "board,,20,0,70,40,30,2,30\n", "utf-8")
    printed("own_reader", room, tmp_path / "room.usda")
    assert "1 trays: board" in printed("own_category", tmp_path / "room.usda", tmp_path / "labelled.usda")
    assert read_scene_file(tmp_path / "labelled.usda")[0]["board"].category == "Tray"


@pytest.mark.slow
def test_a_metric_and_a_report_of_a_folder(homes: Path) -> None:
    assert "chairs in 1 rooms: median" in printed("own_metric", homes)
    assert "home.blend,True," in printed("lesson_report", homes)


@pytest.mark.slow
def test_a_world_and_a_generator_make_scenes(tmp_path: Path) -> None:
    assert "5 scenes" in printed("own_world", tmp_path / "shelves", 5)
    assert len(open_dataset(tmp_path / "shelves")) == 5
    printed("copied_rooms", "--training", tmp_path / "shelves", "--out", tmp_path / "copied", "--count", 2)
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

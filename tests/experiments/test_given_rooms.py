"""Anybody's rooms are measured: a folder of files, a dataset, and what cannot be measured."""

from __future__ import annotations

import json
import runpy
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

pytest.importorskip("sklearn")
pytest.importorskip("bpy")

from unisg_blender.cli import main
from unisg_blender.dataset import write_dataset
from unisg_blender.formats import write_scene_file
from unisg_blender.usd.pxr_library import missing_pxr
from unisg_blender.worlds import cubes, living_room

pytestmark = [pytest.mark.slow, pytest.mark.skipif(bool(missing_pxr()), reason="this Blender has no USD")]
EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "copied_rooms.py"
ROOMS = 6


@pytest.fixture(scope="module")
def sets(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    folder = tmp_path_factory.mktemp("rooms")
    write_dataset((living_room(seed) for seed in range(ROOMS)), folder / "training")
    write_dataset((living_room(1000 + seed) for seed in range(ROOMS)), folder / "test")
    return folder / "training", folder / "test"


Evaluate = Callable[..., dict[str, dict[str, float]]]


@pytest.fixture
def evaluate(sets: tuple[Path, Path], capsys: pytest.CaptureFixture[str]) -> Evaluate:
    def evaluate(rooms: Path, *words: str) -> dict[str, dict[str, float]]:
        """Values of each line of the table."""
        command = ["evaluate", str(rooms), "--data", str(sets[1]), "--quick", "--jobs", "1", "--json", "-q", *words]
        assert main(command) == 0
        return {row["name"]: row["values"] for row in json.loads(capsys.readouterr().out)["rows"]}

    return evaluate


def copied(training: Path, out: Path, centimetres: int, monkeypatch: pytest.MonkeyPatch) -> Path:
    words = [str(training), str(out), str(ROOMS), str(centimetres)]
    monkeypatch.setattr(sys, "argv", [str(EXAMPLE), *words])
    runpy.run_path(str(EXAMPLE), run_name="__main__")
    return out


def test_the_example_is_measured_and_the_more_it_pushes_the_worse_it_is(
    sets: tuple[Path, Path], tmp_path: Path, evaluate: Evaluate, monkeypatch: pytest.MonkeyPatch
) -> None:
    little, much = (copied(sets[0], tmp_path / name, cm, monkeypatch) for name, cm in (("little", 1), ("much", 80)))
    rows = evaluate(little, "--also", str(much), "--out", str(tmp_path / "results"), "--training", str(sets[0]))
    one, other = rows["given rooms"], rows["given rooms, much"]
    assert max(one[name] for name in ("outside", "off_support", "colliding")) < 0.01
    assert other["colliding"] + other["outside"] > 0.1
    assert one["novelty"] == 0 < other["novelty"]
    assert "refused" not in one
    assert "completion_cm" not in one
    assert 0 <= one["c2st_scene_0.03"] <= 1
    assert (tmp_path / "results" / "table.md").is_file()


def test_a_dataset_is_measured_as_it_is(sets: tuple[Path, Path], evaluate: Evaluate) -> None:
    rows = evaluate(sets[1])
    assert rows["given rooms"]["diversity"] == pytest.approx(1)
    assert rows["given rooms"]["colliding"] == rows["real rooms"]["colliding"]


def test_names_are_enough_with_a_mapping(sets: tuple[Path, Path], tmp_path: Path, evaluate: Evaluate) -> None:
    room = living_room(5)
    names = {name: f"{room.category_name(row)} {row}" for row, name in enumerate(room.name)}
    bare = room.replace(name=tuple(names.values()), vocabulary=(), category=room.category * 0 - 1)
    (tmp_path / "rooms").mkdir()
    for number in range(3):
        write_scene_file(bare, tmp_path / "rooms" / f"{number}.json")
    mapping = {"objects": {f"{name} *": name for name in sorted(room.vocabulary, key=len, reverse=True)}}
    (tmp_path / "names.json").write_text(json.dumps(mapping))
    rows = evaluate(tmp_path / "rooms", "--mapping", str(tmp_path / "names.json"))
    assert rows["given rooms"]["colliding"] == 0


def test_what_cannot_be_measured_is_told(
    sets: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def error(folder: str) -> str:
        assert main(["evaluate", str(tmp_path / folder), "--data", str(sets[1]), "--quick", "-q"]) == 1
        return capsys.readouterr().err

    for name in ("empty", "damaged", "foreign", "few"):
        (tmp_path / name).mkdir()
    (tmp_path / "damaged" / "0.usda").write_text("hello")
    write_scene_file(living_room(3), tmp_path / "damaged" / "1.usda")
    write_scene_file(cubes(3), tmp_path / "foreign" / "0.usda")
    assert "neither a dataset nor a scene file" in error("empty")
    assert "1 of 2 scene files cannot be read; " in error("damaged")
    assert "give a --mapping" in error("foreign")
    write_scene_file(living_room(3), tmp_path / "few" / "0.json")
    assert "1 rooms are too few" in error("few")

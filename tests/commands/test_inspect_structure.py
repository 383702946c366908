"""``unisg inspect --structure``: what was recognised, as lines, as JSON and as a plan."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from unisg_blender.cli import main
from unisg_blender.errors import UNUSABLE_INPUT
from unisg_blender.formats.scene_files import write_scene_file
from unisg_blender.geometry.polygon import area

from ..spatial.built_rooms import DOOR, SQUARE, room, scene, table


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "house.usda"
    objects = room(SQUARE, 0.1, roof=True, holes=(DOOR,)) | {"desk": table(2, 2, 0)}
    write_scene_file(scene(objects), path)
    return path


def test_lines_say_what_is_what(file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["inspect", str(file), "--structure"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "1 room on 1 storey"
    assert lines[1].strip() == (
        "0: room of 20.0 m2, storey 0, floor at 0.00 m, 2.50 m high; 4 walls, 1 door, 1 surface for things, with desk"
    )
    assert "  ground: Floor" in lines
    assert "  top: Ceiling" in lines
    assert sum(line.endswith(": Wall") for line in lines) == 4


def test_the_record_has_all_of_it(file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["inspect", str(file), "--structure", "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    (found,) = record["rooms"]
    assert area(np.array(found["outline"])) == pytest.approx(20.0, abs=1e-3)
    assert (found["floor_object"], found["ceiling_object"], found["indoors"]) == ("ground", "top", True)
    assert len(found["walls"]) == 4
    assert [opening["kind"] for opening in found["openings"]] == ["door"]
    assert [surface["object"] for surface in record["surfaces"]] == ["desk"]
    assert found["things"] == ["desk"]


def test_a_plan_is_drawn_or_refused(file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("matplotlib")
    assert main(["inspect", str(file), "--plan", str(tmp_path / "plan.svg")]) == 0
    assert "<svg" in (tmp_path / "plan.svg").read_text(encoding="utf-8")
    capsys.readouterr()
    for path, word in ((tmp_path / "plan.gif", "known kinds"), (tmp_path / "none" / "plan.svg", "no folder")):
        assert main(["inspect", str(file), "--plan", str(path)]) == UNUSABLE_INPUT
        assert word in capsys.readouterr().err
        assert not path.exists()

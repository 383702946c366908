"""The marks of interiors that others made are sound, and simulator worlds are read as they stand."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest

from unisg_blender.formats import read_scene_file
from unisg_blender.geometry.polygon import area
from unisg_blender.spatial.structure import recognise_structure

FOLDER = Path(__file__).parents[2] / "benchmarks" / "interiors"
MARKS = json.loads((FOLDER / "interiors.json").read_text("utf8"))

WORLD = """<?xml version="1.0"?>
<sdf version="1.5"><world name="w">
  <include><uri>model://slab</uri><pose>0 0 -0.05 0 0 0</pose></include>
  {walls}
  <state world_name="w"><model name="side 3"><pose>0 2.1 1.25 0 0 0</pose></model></state>
</world></sdf>"""
WALL = """<model name="side {number}"><pose>{pose}</pose><link name="l"><visual name="v"><geometry>
  <box><size>{size}</size></box></geometry></visual></link></model>"""
SLAB = """<sdf version="1.5"><model name="slab"><link name="l"><visual name="v"><geometry><box><size>6 5 0.1</size>
  </box></geometry></visual></link></model></sdf>"""


def module(name: str):
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    return found


@pytest.mark.parametrize("entry", MARKS["interiors"], ids=lambda entry: entry["name"])
def test_marks_are_sound(entry) -> None:
    source = MARKS["sources"][entry["source"]]
    assert len(source["commit"]) == 40
    assert source["licence"]
    for storey in entry["storeys"]:
        assert storey["outline"]
        assert all(abs(area(np.array(polygon))) > 1 for polygon in storey["outline"] + storey["unclear"])
    for height, *box in entry.get("surfaces", []):
        low, high = np.array(box[:2]), np.array(box[2:])
        assert (low < high).all()
        assert 0.1 <= height - entry["storeys"][0]["floor"] <= 2.2


def test_a_simulator_world_is_read_as_it_stands(tmp_path) -> None:
    """A floor of another model, and walls, one of which the saved state has moved to its place."""
    sides = [("2.6 0 1.25 0 0 0", "0.2 4 2.5"), ("-2.6 0 1.25 0 0 0", "0.2 4 2.5"),
             ("0 -2.1 1.25 0 0 0", "5.4 0.2 2.5"), ("0 9 1.25 0 0 0", "5.4 0.2 2.5")]  # fmt: skip
    walls = "".join(WALL.format(number=n, pose=pose, size=size) for n, (pose, size) in enumerate(sides))
    (tmp_path / "slab").mkdir()
    (tmp_path / "slab" / "model.sdf").write_text(SLAB)
    (tmp_path / "slab" / "model.config").write_text("<model/>")
    (tmp_path / "room.world").write_text(WORLD.format(walls=walls))
    graph = read_scene_file(tmp_path / "room.world")[0]
    (room,) = recognise_structure(graph).rooms
    assert room.indoors
    assert room.area == pytest.approx(20, rel=1e-3)
    assert room.floor == pytest.approx(0, abs=1e-6)


def test_how_outlines_and_surfaces_are_compared() -> None:
    """Two rooms with a wall between them cover one marked outline; a surface counts by what covers most of it."""
    measure = module("measure")
    squares = [np.array([[a, 0], [a + 2.9, 0], [a + 2.9, 4], [a, 4]], float) for a in (0, 3.1)]
    rooms = [_room(square) for square in squares]
    storey = {"floor": 0.0, "outline": [[[0, 0], [6, 0], [6, 4], [0, 4]]], "unclear": []}
    assert measure.outline_overlap(rooms, storey)[0] == pytest.approx(1, abs=0.01)
    assert measure.outline_overlap(rooms[:1], storey)[0] == pytest.approx(2.9 / 6, abs=0.02)
    assert measure.f1(right=3, wrong=1, marked=4, missed=1) == pytest.approx(0.75)


def _room(outline):
    from unisg_blender.spatial.structure import Room

    return Room(outline, (), 0.0, 2.5, 0, True, -1, -1)


def test_what_cannot_be_read_counts_as_not_found(tmp_path, capsys) -> None:
    """One run tells of those chosen on, of those held out, and of all."""
    measure = module("measure")
    storey = {"floor": 0, "outline": [[[0, 0], [6, 0], [6, 5], [0, 5]]], "unclear": []}
    entry = {"name": "one", "source": "some/where", "path": "no.glb", "held_out": True, "storeys": [storey]}
    rows = measure.measured(entry, tmp_path)
    rows.append(rows[0] | {"name": "two", "held_out": False, "iou": 0.9})
    measure.report(rows, tmp_path / "found.json")
    found = json.loads((tmp_path / "found.json").read_text("utf8"))
    assert [found[part]["totals"]["found"] for part in ("dev", "held_out", "all")] == [1.0, 0.0, 0.5]
    assert found["all"]["totals"]["interiors"] == 2

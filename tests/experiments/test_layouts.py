"""Reading rooms that others designed, and what is measured on them; the files are written by hand in their formats."""

from __future__ import annotations

import json
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from unisg_blender.errors import UniSGError
from unisg_blender.experiments.layouts.designed_rooms import read_layouts
from unisg_blender.experiments.layouts.designed_supports import (
    bounds_of,
    by_boxes,
    by_rule,
    support_table,
    times,
)
from unisg_blender.formats.axes import unity_turn
from unisg_blender.scene import world_matrices


def corners(center: list[float], size: list[float], degrees: float = 0.0) -> list[list[float]]:
    """Corners of a box in their axes (y up), the bottom ring first, turned about y."""
    angle, ring = np.radians(degrees), [(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)]
    found = []
    for height, (x, z) in product((-0.5, 0.5), ring):
        dx, dz = x * size[0], z * size[2]
        found.append([
            center[0] + np.cos(angle) * dx + np.sin(angle) * dz,
            center[1] + height * size[1],
            center[2] - np.sin(angle) * dx + np.cos(angle) * dz,
        ])  # fmt: skip
    return found


def ithor_object(name: str, kind: str, center: list[float], size: list[float], on: list[str], turn: float) -> dict:
    boxes: dict[str, Any] = {
        "axisAlignedBoundingBox": {"cornerPoints": corners(center, size)},
        "objectOrientedBoundingBox": {"cornerPoints": corners(center, size, turn)} if turn else None,
    }
    return {"objectId": name, "objectType": kind, "parentReceptacles": on or None, **boxes}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """One small room in each of the three formats."""
    for name in ("ithor", "virtualhome", "tdw"):
        (tmp_path / name).mkdir()
    plan = [
        ithor_object("floor", "Floor", [0, -0.05, 0], [6, 0.1, 4], [], 0),
        ithor_object("table", "CoffeeTable", [1, 0.25, 1], [1, 0.5, 0.6], ["floor"], 0),
        ithor_object("cup", "Mug", [1.2, 0.55, 1.1], [0.08, 0.1, 0.1], ["table"], 30),
    ]
    (tmp_path / "ithor" / "objects.json").write_text(json.dumps({"7": plan}))
    nodes = [
        {"id": 1, "category": "Rooms", "class_name": "kitchen", "bounding_box": _bounds([0, 1, 0], [9, 3, 9])},
        {"id": 2, "category": "Floor", "class_name": "floor", "bounding_box": _bounds([0, -0.05, 0], [4, 0.1, 4])},
        {"id": 3, "category": "Walls", "class_name": "wall", "bounding_box": _bounds([0, 1, 2], [4, 2, 0.1])},
        {"id": 4, "category": "Furniture", "class_name": "desk", "bounding_box": _bounds([1, 0.4, 1], [1, 0.8, 0.5])},
        {"id": 5, "category": "Props", "class_name": "book", "bounding_box": _bounds([1, 0.3, 1], [0.1, 0.1, 0.1])},
    ]
    edges = [
        {"from_id": 4, "to_id": 2, "relation_type": "ON"},
        {"from_id": 3, "to_id": 2, "relation_type": "ON"},
        {"from_id": 5, "to_id": 4, "relation_type": "INSIDE"},
        {"from_id": 5, "to_id": 1, "relation_type": "INSIDE"},
        {"from_id": 5, "to_id": 4, "relation_type": "CLOSE"},
    ]
    (tmp_path / "virtualhome" / "Home_graph.json").write_text(json.dumps({"nodes": nodes, "edges": edges}))
    item = {"name": "stool_a", "position": _xyz(1, 0, 2), "rotation": _xyz(0, 90, 0), "scale_factor": _xyz(2, 1, 1)}
    sides = {"left": _xyz(-0.2, 0.2, 0), "right": _xyz(0.2, 0.2, 0), "front": _xyz(0, 0.2, 0.1)}
    sides |= {"back": _xyz(0, 0.2, -0.1), "bottom": _xyz(0, 0, 0), "top": _xyz(0, 0.4, 0)}
    models = {"records": {"stool_a": {"wcategory": "stool", "bounds": sides}}}
    (tmp_path / "tdw" / "floorplan_layouts.json").write_text(json.dumps({"2": {"0": [item, {**item, "name": "lost"}]}}))
    (tmp_path / "tdw" / "models_core.json").write_text(json.dumps(models))
    return tmp_path


def _bounds(center: list[float], size: list[float]) -> dict[str, list[float]]:
    return {"center": center, "size": size}


def _xyz(x: float, y: float, z: float) -> dict[str, float]:
    return {"x": x, "y": y, "z": z}


def test_objects_stand_upright_where_they_stood(folder: Path) -> None:
    ithor, home, tdw = read_layouts(folder)
    assert (ithor.name, home.name, tdw.name) == ("iTHOR 7", "VirtualHome Home", "TDW 2-0")
    graph = ithor.graph
    cup = graph.row("Mug")
    np.testing.assert_allclose(world_matrices(graph)[cup, :3, 3], (1.2, 1.1, 0.5), atol=1e-9)
    low, high = bounds_of(graph)
    np.testing.assert_allclose(low[graph.row("Coffee Table")], (0.5, 0.7, 0.0), atol=1e-6)
    np.testing.assert_allclose(high[graph.row("Coffee Table")], (1.5, 1.3, 0.5), atol=1e-6)
    turned = np.abs(np.cos(np.radians(30))) * 0.08 + np.sin(np.radians(30)) * 0.1
    np.testing.assert_allclose((high - low)[cup, 0], turned, atol=1e-6)
    low, high = bounds_of(tdw.graph)  # scaled, then turned by a quarter: long along y now
    np.testing.assert_allclose((high - low)[0], (0.2, 0.8, 0.4), atol=1e-6)
    np.testing.assert_allclose((low + high)[0, :2] / 2, (1.0, 2.0), atol=1e-6)


def test_what_they_say_of_supports(folder: Path) -> None:
    ithor, home, tdw = read_layouts(folder)
    row = ithor.graph.row
    assert ithor.supports == {(row("Coffee Table"), row("Floor")), (row("Mug"), row("Coffee Table"))}
    row = home.graph.row
    assert home.supports == {(row("desk"), row("Floor"))}
    assert home.unclear == {(row("book"), row("desk"))}
    assert tdw.supports is None
    assert tdw.graph.name == ("stool",)


def test_rule_and_boxes_find_what_stands_on_what(folder: Path) -> None:
    rooms = read_layouts(folder)
    methods = [("rule", by_rule, 0.5), ("boxes", by_boxes, 0.5), ("both", times(by_rule, by_boxes), 0.5)]
    rows = {(row.room, row.method): row for row in support_table(rooms, methods)}
    for method in ("rule", "boxes", "both"):
        assert rows["iTHOR 7", method].average_precision == 1.0
        assert rows["iTHOR 7", method].f1 == 1.0
    assert rows["all", "rule"].pairs == 3
    assert not any(room.startswith("TDW") for room, _ in rows)


def test_a_turn_about_their_up_axis_goes_the_other_way_here() -> None:
    turn = unity_turn({"x": 0, "y": 90, "z": 0})
    np.testing.assert_allclose(turn @ (1, 0, 0), (0, -1, 0), atol=1e-12)
    assert np.linalg.det(unity_turn({"x": 10, "y": 20, "z": 30})) == pytest.approx(1.0)


def test_a_folder_without_layouts_and_a_damaged_file_are_told(folder: Path, tmp_path: Path) -> None:
    (folder / "ithor" / "objects.json").write_text("{")
    with pytest.raises(UniSGError, match=r"objects\.json"):
        read_layouts(folder)
    empty = tmp_path / "empty"
    empty.mkdir()
    with pytest.raises(UniSGError, match="no layouts"):
        read_layouts(empty)

"""What the benchmarks count, in scenes small enough to count by hand."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from unisg_blender.experiments.rooms.frozen_rooms import PARTS
from unisg_blender.worlds import WORLDS

BENCHMARKS = Path(__file__).resolve().parents[1] / "benchmarks"


def benchmark(name: str) -> ModuleType:
    """A benchmark as a module."""
    spec = importlib.util.spec_from_file_location(f"benchmark_{name}", BENCHMARKS / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_rooms_are_counted() -> None:
    worlds, graphs = benchmark("worlds"), [WORLDS["living-room"](seed) for seed in (0, 1)]
    part = worlds.of_part(PARTS[2], graphs)
    assert part["objects"] == sum(
        graph.category_name(row) not in ("Floor", "Wall", "Door", "Window") and graph.mesh[row] >= 0
        for graph in graphs
        for row in range(len(graph))
        if graph.category[row] >= 0
    )
    assert part["rectangular"] + part["slanted"] + part["square"] == 2
    assert part["faults"] == 0
    sofa = next(row for row in worlds.of_categories("living-room", graphs) if row["category"] == "Sofa")
    assert (sofa["in_rooms"], sofa["each"], sofa["levels"]) == (1.0, 1.0, "1")
    assert sofa["x"] > sofa["y"] > 0.5


def test_relations_are_scored() -> None:
    scores = benchmark("relations").scores([{(1, 0), (2, 0), (3, 0)}, set()], [{(1, 0), (2, 1)}, {(4, 0)}])
    assert scores["edges"] == 3
    assert scores["precision"] == pytest.approx(1 / 3)
    assert scores["recall"] == pytest.approx(1 / 3)
    assert scores["f1"] == pytest.approx(1 / 3)
    assert benchmark("relations").scores([set()], [set()])["precision"] is None


def test_scenes_are_turned_as_a_whole_about_the_vertical() -> None:
    graph = WORLDS["cubes"](0)
    turned = benchmark("scene_kinds").turned(graph, seed=3)
    between = np.linalg.inv(graph.world) @ turned.world
    turn = turned.world[0] @ np.linalg.inv(graph.world[0])
    assert np.allclose(turned.world, turn @ graph.world)
    assert np.allclose(turn[2], (0, 0, 1, 0))
    assert not np.allclose(between, np.eye(4))

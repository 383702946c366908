"""The judge of round trips notices what is lost; benchmarks/round_trip.py asks it about scenes of others."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from benchmarks.round_trip import difference, drawn
from unisg_blender.formats import write_scene_file
from unisg_blender.worlds import cubes

SEEN: dict[str, Any] = {
    "frame": 1.0, "last": 250.0, "meshes": 2, "points": 16, "shapes": 0,
    "low": [0.0, 0.0, 0.0], "high": [1.0, 2.0, 1.0], "mean": [0.5, 1.0, 0.5], "origins": [0.0, 0.0, 0.0],
}  # fmt: skip


@pytest.mark.parametrize(
    "change",
    [
        {"frame": 2.0}, {"last": 100.0}, {"meshes": 3}, {"points": 15}, {"low": [0.0, -0.1, 0.0]},
        {"mean": [0.5, 1.1, 0.5]}, {"origins": [0.0, 0.0, 1.0]}, {"high": [1.0, float("nan"), 1.0]},
    ],
)  # fmt: skip
def test_every_loss_is_noticed(change: dict[str, Any]) -> None:
    assert difference(SEEN, SEEN) == "same"
    assert difference(SEEN, SEEN | change) != "same"


def test_what_nobody_sees_is_told_apart() -> None:
    assert difference({}, SEEN) == "unseen"
    assert difference(SEEN | {"points": 0}, SEEN) == "empty"
    assert difference(SEEN | {"frame": None, "last": None}, SEEN) == "same"
    assert difference(SEEN | {"shapes": 1}, SEEN | {"points": 99, "mean": [0.0, 0.0, 0.0]}) == "same"


def test_kinds_and_repositories_come_in_turn(tmp_path: Path) -> None:
    for name in ("a/1.glb", "a/2.glb", "a/3.glb", "b/4.glb", "b/5.obj", "b/known.obj"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    order = [path.relative_to(tmp_path).as_posix() for path in drawn(tmp_path, {"known.obj"}, 1)]
    assert sorted(order) == ["a/1.glb", "a/2.glb", "a/3.glb", "b/4.glb", "b/5.obj"]
    assert order[1] == "b/5.obj"
    assert order[2] == "b/4.glb"
    assert order == [path.relative_to(tmp_path).as_posix() for path in drawn(tmp_path, {"known.obj"}, 1)]


@pytest.mark.slow
def test_blender_and_usd_see_the_same_of_a_scene(tmp_path: Path) -> None:
    pytest.importorskip("bpy")
    graph = cubes(seed=1)
    found = []
    for ending in ("usda", "blend"):  # a still scene has no frames in USD
        write_scene_file(graph, tmp_path / f"scene.{ending}")
        words = [sys.executable, "benchmarks/seen_geometry.py", str(tmp_path / f"scene.{ending}")]
        done = subprocess.run(words, cwd=Path(__file__).parents[1], capture_output=True, text=True, check=True)
        found.append(json.loads(done.stdout.splitlines()[-1]))
    assert found[1]["meshes"] > 10
    assert difference(*found) == "same"

"""What is printed stays readable however much there is to tell; ``--json`` has all of it."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pytest

from unisg_blender.formats import write_scene_file
from unisg_blender.formats.scene_files import read_scene_file
from unisg_blender.scene import SceneBuilder
from unisg_blender.usd.pxr_library import missing_pxr
from unisg_blender.worlds import cubes

needs_usd = pytest.mark.skipif(bool(missing_pxr()), reason="this Blender has no USD")

Run = Callable[..., tuple[str, str]]


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    write_scene_file(cubes(seed=3), tmp_path / "cubes.json")
    return tmp_path / "cubes.json"


def test_relations_are_counted_and_each_pair_is_told_once(scene: Path, run: Run) -> None:
    whole = json.loads(run("relations", scene, "--json")[0])["relations"]
    *lines, total = run("relations", scene, "--limit", 0)[0].splitlines()
    counts = Counter(item["kind"] for item in whole)
    once = counts["on_top_of"] + counts["above"] + counts["left_of"] + counts["in_front_of"]
    assert len(lines) == once + (counts["beside"] + counts["connected_to"]) / 2
    assert total.endswith(
        f"on top of {counts['on_top_of']}, above {counts['above']}, left of {counts['left_of']}, "
        f"in front of {counts['in_front_of']}, beside {counts['beside'] // 2}, "
        f"connected to {counts['connected_to'] // 2}"
    )
    assert not any("  below  " in line for line in lines)
    assert any("  below  " in line for line in run("relations", scene, "--kind", "below")[0].splitlines())
    shown = run("relations", scene, "--limit", 2)[0].splitlines()
    assert shown[:2] == lines[:2]
    assert shown[2].startswith(f"... and {len(lines) - 2} more relations")
    assert len(shown) == 4
    assert "on top of" in lines[0]


def test_no_relation_is_said(tmp_path: Path, run: Run) -> None:
    builder = SceneBuilder("empty")
    builder.add("Nothing", uid="n")
    write_scene_file(builder.build(), tmp_path / "empty.json")
    assert "no such relation between its 1 entities" in run("relations", tmp_path / "empty.json")[0]


@needs_usd
def test_what_many_prims_lose_is_one_line(tmp_path: Path, run: Run) -> None:
    lamps = "\n".join(f'def DomeLight "Lamp{number}" {{}}' for number in range(300))
    (tmp_path / "lamps.usda").write_text(f'#usda 1.0\n(upAxis = "Z"\nmetersPerUnit = 1)\n{lamps}\n')
    out, err = run("inspect", tmp_path / "lamps.usda", "--limit", 5)
    losses = [line for line in err.splitlines() if line.startswith("not represented")]
    assert losses == [
        "not represented: lights of this kind keep their place only (300 objects: /Lamp0, /Lamp1, /Lamp2 and 297 more)"
    ]
    assert "... and 295 more entities" in out
    whole = json.loads(run("inspect", tmp_path / "lamps.usda", "--json")[0])
    assert "/Lamp299: lights of this kind keep their place only" in whole["not_represented"]
    assert len(whole["not_represented"]) == 300


@needs_usd
def test_damage_of_a_prim_is_told_by_its_path(tmp_path: Path) -> None:
    faces = "int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0,1,2]"
    bad = f'def Mesh "Bad" {{\npoint3f[] points = [(0,0,0)]\n{faces}\n}}'
    (tmp_path / "bad.usda").write_text(f'#usda 1.0\n(upAxis = "Z"\nmetersPerUnit = 1)\n{bad}\n')
    _, lost = read_scene_file(tmp_path / "bad.usda")
    assert any(name == "/Bad" and "faces are left out" in text for name, text in lost.entries)


@pytest.mark.slow
def test_alike_refusals_of_a_generator_are_one_line(tmp_path: Path, run: Run) -> None:
    words = ("generate", "--add", "Floor=1,Wall=4,Operating Table=40", "--seed", 1, "--limit", 3)
    out, _ = run(*words, "--out", tmp_path / "room.json", status=3)
    assert len(out.splitlines()) < 12
    assert sum("x Operating Table: no place: " in line for line in out.splitlines()) == 1


def test_a_negative_limit_is_refused(scene: Path, run: Run) -> None:
    for verb in ("relations", "inspect", "label"):
        assert "--limit: must be a whole number from 0" in run(verb, scene, "--limit", "-1", status=1)[1]

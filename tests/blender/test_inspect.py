"""``unisg inspect``: one tree through every door, clean output, exit statuses."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import bpy
import pytest

from unisg_blender.blender import save_blend
from unisg_blender.usd.pxr_library import missing_pxr

DATA = Path(__file__).parents[1] / "data"
NESTED = DATA / "usd-wg-assets/test_assets/schemaTests/usdGeom/transforms/xforms_nested.usda"
RIG = DATA / "vrm-addon" / "share_mesh_modified_and_non_modified_vrm1.blend"


def unisg(*words: object, limit: float = 120) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "unisg_blender", *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, timeout=limit, check=False)


@pytest.mark.slow
@pytest.mark.skipif(bool(missing_pxr()), reason="this Blender offers no USD to Python")
def test_the_tree_and_nothing_else_on_stdout() -> None:
    done = unisg("inspect", NESTED, "-q")
    assert done.returncode == 0
    lines = done.stdout.splitlines()
    assert len(lines) == 8
    assert {(len(line) - len(line.lstrip())) // 2 for line in lines} == {0, 1, 2, 3}
    assert not done.stderr


@pytest.mark.slow
def test_json_holds_the_whole_scene() -> None:
    done = unisg("inspect", RIG, "--json")
    record = json.loads(done.stdout)
    assert record["entities"] == len(record["records"]) == 9
    assert record["types"]["ARMATURE"] == 1
    assert any("vertex groups" in line for line in record["not_represented"])


def test_limit_and_summary() -> None:
    done = unisg("inspect", RIG, "--limit", 2, "--geometry", "none")
    assert "and 7 more entities" in done.stdout
    assert "9 entities" in done.stdout
    assert "not represented:" in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize(("words", "status"), [(["inspect", "missing.glb"], 1), (["inspect"], 2)])
def test_exit_statuses(words: list[str], status: int) -> None:
    done = unisg(*words)
    assert done.returncode == status
    assert not done.stdout
    assert "Traceback" not in done.stderr


@pytest.mark.slow
def test_damaged_file(tmp_path: Path) -> None:
    (tmp_path / "scene.glb").write_text("hello")
    done = unisg("inspect", tmp_path / "scene.glb")
    assert done.returncode == 1
    assert len(done.stderr.splitlines()) == 1


def test_a_driver_that_blender_evaluates_with_python_does_not_keep_the_process(tmp_path: Path) -> None:
    item = bpy.data.objects.new("moved", None)
    bpy.context.scene.collection.objects.link(item)
    driver = item.driver_add("location", 0).driver
    driver.type, driver.expression = "SCRIPTED", "frame**2 * 0.001"
    save_blend(tmp_path / "driven.blend")
    done = unisg("inspect", tmp_path / "driven.blend", limit=30)
    assert done.returncode == 0
    assert "drivers: only their result is kept" in done.stderr
    assert done.stdout.splitlines()[-1].startswith("frames:")

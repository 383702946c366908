"""Variations and labelled pictures of the open scene, by the operators that dialog and menus call."""

from __future__ import annotations

import json
from importlib import import_module
from pathlib import Path

import bpy
import numpy as np
import pytest

from tests.extension_package import NAME
from unisg_blender.blender import read_scene, write_scene
from unisg_blender.formats.scene_files import read_scene_file
from unisg_blender.scene import SceneGraph
from unisg_blender.worlds import living_room

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("extension", "fresh_file")]


def room(*selected: str) -> SceneGraph:
    bpy.context.window.scene = write_scene(living_room(1))
    for item in bpy.context.scene.objects:
        item.select_set(item.name in selected)
    return read_scene(details=False)


def moved(before: SceneGraph, after: SceneGraph) -> set[str]:
    """Names of what stands elsewhere, or is gone."""
    place = {uid: after.world[row] for row, uid in enumerate(after.uid)}
    return {
        before.name[row]
        for row, uid in enumerate(before.uid)
        if uid not in place or not np.allclose(place[uid], before.world[row], atol=1e-4)
    }


def test_what_is_selected_varies_and_the_rest_stays(tmp_path: Path) -> None:
    before = room("Cup")
    known = set(bpy.data.objects.keys())
    made = bpy.ops.unisg.make_variations(folder=str(tmp_path / "out"), count=2, format="json", seed=3)
    assert made == {"FINISHED"}
    files = sorted((tmp_path / "out").glob("*.json"))
    assert [path.name[-10:] for path in files] == ["00003.json", "00004.json"]
    for path in files:
        after = read_scene_file(path)[0]
        assert moved(before, after) == {"Cup"}
    records = [json.loads(line) for line in (tmp_path / "out" / "report.jsonl").read_text().splitlines()]
    assert [record["status"] for record in records] == ["ok", "ok"]
    assert set(bpy.data.objects.keys()) == known
    assert not bpy.data.filepath
    with pytest.raises(RuntimeError, match="exists already"):
        bpy.ops.unisg.make_variations(folder=str(tmp_path / "out"), count=2, format="json", seed=3)


def test_what_has_to_be_chosen_is_said(tmp_path: Path) -> None:
    room()
    with pytest.raises(RuntimeError, match="choose a folder"):
        bpy.ops.unisg.make_variations(count=1)
    with pytest.raises(RuntimeError, match="save this file first"):
        bpy.ops.unisg.make_variations(count=1, folder="//out")
    with pytest.raises(RuntimeError, match="select the objects"):
        bpy.ops.unisg.make_variations(count=1, folder=str(tmp_path / "out"))
    with pytest.raises(RuntimeError, match="must look like"):
        bpy.ops.unisg.render_labels(folder=str(tmp_path / "out"), views="eye=")


def test_selected_things_or_padlocked_ones_are_locked() -> None:
    before = room("Cup")
    bpy.data.objects["Remote"]["unisg_lock"] = "yes"
    module = import_module(f"{NAME}.operators.many.variations")

    class Asked:
        selection, jitter = "LOCK", 0.1
        varied = module.UNISG_OT_make_variations._variation

    record = Asked.varied(Asked, bpy.context)  # type: ignore[arg-type]
    assert record["reroll"] == ["*"]
    assert {before.name[before.row_of_uid[uid]] for uid in record["lock"]} == {"Cup", "Remote"}
    assert record["jitter"] == {"distance": pytest.approx(0.1)}


def test_pictures_with_labels_of_the_open_scene(tmp_path: Path) -> None:
    room()
    given = {"folder": str(tmp_path / "out"), "views": "eye=1", "width": 64, "height": 48, "engine": "workbench"}
    assert bpy.ops.unisg.render_labels_dialog(**given) == {"FINISHED"}
    (label,) = (tmp_path / "out" / "labels").iterdir()
    assert json.loads(label.read_text())["objects"]
    assert (tmp_path / "out" / "instances.json").exists()
    assert (tmp_path / "out" / "pictures" / f"{label.stem}.png").exists()

"""A master file that Blender's own importer opens is still the same scene: places, lights, lenses, identities."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("bpy")

import bpy

from tests.blender.helpers import add, box, relative_gap
from unisg_blender.blender import objects_by_uid, read_scene
from unisg_blender.blender.authoring.identities import repair_identities
from unisg_blender.scene import ActionData, SceneGraph, world_matrices
from unisg_blender.scene.action_data import actions_to_json
from unisg_blender.usd import write_usd

LIGHTS = {"POINT": 30.0, "SUN": 3.0, "SPOT": 40.0, "AREA": 50.0}


def entity(name: str, data: object = None, parent: object = None) -> object:
    item = add(name, data, parent)
    item["unisg_uid"], item["unisg_category"] = f"uid {name}", f"Kind of {name}"
    item.location = (1, 2, len(name))
    return item


def room() -> None:
    for kind, energy in LIGHTS.items():
        light = bpy.data.lights.new(kind, kind)
        light.energy, light.color = energy, (1, 0.5, 0.25)
        entity(kind, light)
    camera = bpy.data.cameras.new("Eye")
    camera.lens, camera.shift_x, camera.clip_end = 35, 0.1, 77
    camera.dof.use_dof, camera.dof.focus_distance, camera.dof.aperture_fstop = True, 3, 4
    entity("Eye", camera)
    table = entity("Table", box())
    cup = entity("Cup", box("Small", 0.1), table)
    cup["unisg_actions"] = actions_to_json([ActionData("take", "Remove", targets=("uid Cup",), tools=("uid Table",))])
    cup["weight"] = 0.25
    entity("Marker")


@pytest.fixture
def imported(tmp_path: Path) -> SceneGraph:
    """The scenegraph that was written; Blender has imported its file into an empty scene."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    room()
    bpy.context.view_layer.update()
    graph = read_scene()
    write_usd(graph, tmp_path / "room.usdc")
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.wm.usd_import(filepath=str(tmp_path / "room.usdc"))
    bpy.context.view_layer.update()
    return graph


def test_lights_and_lenses_are_blenders(imported: SceneGraph) -> None:
    for kind, energy in LIGHTS.items():
        light = bpy.data.objects[kind].data
        assert (light.type, light.energy) == (kind, pytest.approx(energy, rel=1e-5))
        assert tuple(light.color) == pytest.approx((1, 0.5, 0.25), abs=1e-3)
    camera = bpy.data.objects["Eye"].data
    assert (camera.lens, camera.shift_x, camera.clip_end) == pytest.approx((35, 0.1, 77))
    assert camera.dof.use_dof
    assert (camera.dof.focus_distance, camera.dof.aperture_fstop) == pytest.approx((3, 4))


def test_the_same_entities(imported: SceneGraph) -> None:
    graph = read_scene()
    assert graph.name == imported.name
    assert graph.uid == imported.uid
    np.testing.assert_array_equal(graph.type, imported.type)
    np.testing.assert_array_equal(graph.parent, imported.parent)
    assert relative_gap(world_matrices(graph), world_matrices(imported)) < 1e-5
    for row in range(len(graph)):
        assert graph.category_name(row) == imported.category_name(row)
        assert graph[row].actions == imported[row].actions
    assert graph["Cup"].component("properties")["json"].tolist() == ['{"weight": 0.25}']
    assert len(graph["Table"].mesh.points) == 8


def test_identities_stay_when_they_are_repaired(imported: SceneGraph) -> None:
    assert set(imported.uid) <= set(objects_by_uid(bpy.context.scene))
    repair_identities(bpy.context.scene)
    assert read_scene().uid == imported.uid

"""One room in metres, centimetres and inches: the same scenegraph, and the scene's own unit when written."""

from __future__ import annotations

import struct
from pathlib import Path

import bpy
import numpy as np
import pytest

from tests.blender.helpers import add, assert_same_scene, box
from unisg_blender.blender import ReadReport, objects_by_uid, read_scene, scene_units, write_rows, write_scene
from unisg_blender.blender.authoring.stored_behaviour import actions_of, world_of
from unisg_blender.blender.motion.scene_recording import (
    SceneRecorder,
    record_playback,
    replay,
    scene_recording,
    store_recording,
)
from unisg_blender.blender.render.film import Puppets
from unisg_blender.formats import read_scene_file, write_scene_file
from unisg_blender.scene import SceneGraph, world_matrices
from unisg_blender.usd.pxr_library import missing_pxr
from unisg_blender.worlds import operating_room

UNITS = [("METRIC", 1.0), ("METRIC", 0.01), ("IMPERIAL", 0.0254)]
POINTS = 1e-6
"""Metres that a float32 in another unit may be off, in a room of a few metres."""


def furnished(system: str, metres: float) -> bpy.types.Scene:
    """The room as its maker draws it in a unit: every length typed in that unit, no object scaled."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene, unit = bpy.context.scene, 1.0 / metres
    scene.unit_settings.system, scene.unit_settings.scale_length = system, metres
    table = add("Table", box("Top", 0.8 * unit))
    table.location, table.rotation_euler, table["unisg_category"] = (
        (2 * unit, 1 * unit, 0.4 * unit),
        (0, 0, 0.3),
        "Table",
    )
    cup = add("Cup", box("Cup", 0.1 * unit), table)
    cup.location, cup.rotation_mode, cup.scale = (0.2 * unit, 0, 0.45 * unit), "QUATERNION", (1, 1, 2)
    cup.matrix_parent_inverse.translation = (0, 0.1 * unit, 0)
    cup.delta_location = (0, 0, 0.3 * unit)
    camera = add("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.data.clip_start, camera.data.clip_end = (0, -4 * unit, 2 * unit), 0.1 * unit, 30 * unit
    camera.data.ortho_scale, camera.data.dof.focus_distance = 6 * unit, 5 * unit
    for place, (kind, watts) in enumerate([("AREA", 60 * unit**2), ("SUN", 3)]):
        lamp = add(kind, bpy.data.lights.new(kind, kind))
        lamp.location, lamp.data.energy = (place * unit, 2 * unit, 2.5 * unit), watts
        lamp.data.shadow_soft_size = 0.25 * unit
        if kind == "AREA":
            lamp.data.size = lamp.data.size_y = 0.4 * unit
    mark = add("Mark")
    mark.location, mark.empty_display_type, mark.empty_display_size = (unit, 0, 0), "ARROWS", 0.5 * unit
    chairs = bpy.data.collections.new("Chairs")
    seat = bpy.data.objects.new("Seat", box("Seat", 0.45 * unit))
    seat.location = (3 * unit, 0, 0.2 * unit)
    chairs.objects.link(seat)
    chairs.instance_offset = (3 * unit, 0, 0)
    copies = add("Copies")
    copies.instance_type, copies.instance_collection, copies.location = "COLLECTION", chairs, (0, 3 * unit, 0)
    for frame, x in ((1, 0.0), (5, 1.2)):
        mark.location.x = x * unit
        mark.keyframe_insert("location", frame=frame)
    scene.frame_start, scene.frame_end = 1, 5
    scene.frame_set(1)
    bpy.context.view_layer.update()
    return scene


@pytest.fixture
def in_metres() -> SceneGraph:
    """The scenegraph of the room that was drawn in metres."""
    return read_scene(furnished("METRIC", 1.0), animation=True)


@pytest.mark.parametrize(("system", "metres"), UNITS[1:])
def test_every_unit_reads_the_same(in_metres: SceneGraph, system: str, metres: float) -> None:
    graph = read_scene(furnished(system, metres), animation=True)
    assert_same_scene(in_metres, graph, POINTS)
    np.testing.assert_allclose(graph.local, in_metres.local, atol=POINTS)
    channels = [each["Cup"].component("channels") for each in (graph, in_metres)]
    for key in ("location", "delta_location", "inverse", "scale"):
        np.testing.assert_allclose(channels[0][key], channels[1][key], atol=POINTS)
    moves = [each["Mark"].component("animation")["matrices"][0] for each in (graph, in_metres)]
    np.testing.assert_allclose(moves[0], moves[1], atol=POINTS)
    assert moves[0][-1][0, 3] == pytest.approx(1.2)


@pytest.mark.parametrize(("system", "metres"), UNITS)
def test_a_room_comes_back_in_the_unit_of_its_scene(in_metres: SceneGraph, system: str, metres: float) -> None:
    drawn = {
        item.name: (np.array(item.matrix_world), np.array(item.dimensions))
        for item in furnished(system, metres).objects
    }
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    scene = bpy.context.scene
    scene.unit_settings.system, scene.unit_settings.scale_length = system, metres
    write_scene(in_metres, scene)
    scene.frame_set(1)
    bpy.context.view_layer.update()
    for name, (world, dimensions) in drawn.items():
        item = bpy.data.objects[name]
        np.testing.assert_allclose(item.matrix_world, world, atol=2e-6 / metres, err_msg=name)
        np.testing.assert_allclose(item.dimensions, dimensions, atol=2e-6 / metres, err_msg=name)
    assert bpy.data.objects["AREA"].data.energy == pytest.approx(60 / metres**2)
    assert bpy.data.objects["SUN"].data.energy == pytest.approx(3)
    assert bpy.data.objects["Camera"].data.clip_end == pytest.approx(30 / metres)
    assert_same_scene(in_metres.replace(frames=None), read_scene(scene), POINTS)


def test_new_rows_have_the_size_of_the_scene(in_metres: SceneGraph) -> None:
    scene = furnished("METRIC", 0.01)
    graph = read_scene(scene, details=False)
    fresh = in_metres.replace(uid=tuple(uid + " new" for uid in in_metres.uid))
    row = graph.row("Table")
    assert graph.meshes[graph.mesh[row]].bounds[1] == pytest.approx([0.4] * 3)
    (new,) = write_rows(fresh, [fresh.row("Table")], scene)
    bpy.context.view_layer.update()
    assert np.array(new.dimensions) == pytest.approx([80.0] * 3)
    assert np.array(new.matrix_world.translation) == pytest.approx([200, 100, 40])
    assert np.array(new.scale) == pytest.approx([1.0] * 3)


def test_actions_come_back_and_are_kept_in_the_unit() -> None:
    room = operating_room(5)
    scene = bpy.context.scene
    scene.unit_settings.scale_length = 0.01
    write_scene(room, scene)
    again, kept = read_scene(scene), objects_by_uid(scene)
    posed = [(row, each) for row, each in room.entries("actions", "data") if each.reference is not None]
    assert posed
    for row, action in posed:
        found = next(each for each in again[again.row_of_uid[room.uid[row]]].actions if each.uid == action.uid)
        stored = next(each for each in actions_of(kept[room.uid[row]]) if each.uid == action.uid)
        assert found.reference == pytest.approx(action.reference)
        assert stored.reference_matrix[:3, 3] == pytest.approx(action.reference_matrix[:3, 3] * 100)
        assert found.thresholds == stored.thresholds == action.thresholds


def test_recordings_are_kept_and_replayed_in_the_unit() -> None:
    scene = furnished("METRIC", 0.01)
    graph = record_playback(scene)
    store_recording(graph, scene)
    assert scene_recording(scene)["Mark"].matrices[-1][0, 3] == pytest.approx(120)
    again = read_scene(scene)
    for each in (graph, again):
        moved = each["Mark"].component("recording")["matrices"][0]
        assert (moved[0][0, 3], moved[-1][0, 3]) == pytest.approx((0.0, 1.2))
    assert replay(again, scene) == 1
    scene.frame_set(5)
    assert bpy.data.objects["Mark"].matrix_world.translation.x == pytest.approx(120)


def test_what_is_watched_is_in_metres_and_films_in_the_unit() -> None:
    scene = furnished("METRIC", 0.01)
    graph = read_scene(scene)
    world = world_of(graph, scene, objects_by_uid(scene), np.zeros((len(graph), 4, 4)))
    np.testing.assert_allclose(world, world_matrices(graph), atol=POINTS)
    recorder = SceneRecorder()
    recorder.sample(scene, 0.0)
    bpy.data.objects["Table"].location.x += 50
    bpy.context.view_layer.update()
    recorder.sample(scene, 1.0)
    moved = recorder.recorded(graph)["Table"].component("recording")["matrices"][0]
    assert moved[-1][0, 3] - moved[0][0, 3] == pytest.approx(0.5)
    Puppets(scene, graph).pose(world)
    assert np.array(bpy.data.objects["Table"].matrix_world.translation) == pytest.approx([200, 100, 40])


@pytest.mark.skipif(bool(missing_pxr()), reason=missing_pxr())
def test_files_are_in_metres(in_metres: SceneGraph, tmp_path: Path) -> None:
    furnished("METRIC", 0.01)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "room.blend"), copy=True)
    graph, lost = read_scene_file(tmp_path / "room.blend")
    assert [line for line in lost if "its unit of 0.01 m" in line]
    for suffix in (".usda", ".blend"):
        write_scene_file(graph, tmp_path / f"out{suffix}")
        again, lost = read_scene_file(tmp_path / f"out{suffix}")
        assert not [line for line in lost if "unit" in line]
        np.testing.assert_allclose(world_matrices(again)[again.row("Table")], in_metres["Table"].world, atol=POINTS)
        assert again["Table"].mesh.bounds[1] == pytest.approx([0.4] * 3)
    assert "metersPerUnit = 1\n" in (tmp_path / "out.usda").read_text()


@pytest.mark.parametrize(
    ("system", "said", "told"),
    [
        ("NONE", 0.01, "the unit scale 0.01 is not applied, there is no unit system"),
        ("METRIC", 0.0, "the unit scale 0 is not applied, it cannot be"),
        ("METRIC", float("nan"), "the unit scale nan is not applied, it cannot be"),
        ("METRIC", 1e9, "the unit scale 1e+09 is not applied, it cannot be"),
    ],
)
def test_a_unit_that_does_not_count_is_told(tmp_path: Path, system: str, said: float, told: str) -> None:
    scene = furnished("METRIC", 1.0)
    scene.unit_settings.system, scene.unit_settings.scale_length = system, 0.7654321
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "room.blend"), copy=True, compress=False)
    data = (tmp_path / "room.blend").read_bytes()
    (tmp_path / "room.blend").write_bytes(data.replace(struct.pack("<f", 0.7654321), struct.pack("<f", said)))
    graph, lost = read_scene_file(tmp_path / "room.blend")
    assert [line for line in lost if told in line]
    assert graph["Table"].world[:3, 3] == pytest.approx([2, 1, 0.4])


def test_metres_change_nothing(in_metres: SceneGraph) -> None:
    scene = bpy.context.scene
    points = np.empty(24, np.float32)
    bpy.data.objects["Table"].data.attributes["position"].data.foreach_get("vector", points)
    assert scene_units.in_metres(in_metres, scene) is in_metres is scene_units.in_scene_units(in_metres, scene)
    np.testing.assert_array_equal(in_metres["Table"].mesh.points.ravel(), points)
    np.testing.assert_array_equal(in_metres["Table"].local[:3, 3], np.array(bpy.data.objects["Table"].location))
    report = ReadReport()
    read_scene(scene, report=report)
    assert not [line for line in report if "unit" in line]

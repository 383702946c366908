"""Screw interpolation, keyframe reduction, transform forms and the microscope in real Blender."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import MagicMock

import bpy
import numpy as np
import pytest
from mathutils import Matrix, Quaternion

from unisg_blender import UniSGError
from unisg_blender.blender.motion import keyframes
from unisg_blender.blender.motion.keyframes import key_count, key_times, read_motors
from unisg_blender.blender.motion.motor_keys import Tolerance, interpolate_with_motors, reduce_item_keyframes
from unisg_blender.blender.viewport import motion_paths as microscope
from unisg_blender.blender.viewport.transform_forms import transform_forms, transform_text
from unisg_blender.poses import FORMS, pose_errors, rebuild
from unisg_blender.poses.paths import PATH_NAMES, compare_paths

ROOT = Path(__file__).resolve().parents[2]
MODES = ["QUATERNION", "AXIS_ANGLE", "XYZ", "ZYX", "YXZ"]
POSES = [
    (1, (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0.0),
    (40, (-1.0, 0.0, 0.5), (0.0, 0.0, 1.0), 170.0),
    (75, (0.3, -2.0, 1.0), (1.0, 1.0, 0.0), 90.0),
    (90, (0.3, -2.0, 1.0), (1.0, -1.0, 0.2), 30.0),
]


def keyed(mode: str = "QUATERNION", poses: list = POSES, name: str = "Body") -> bpy.types.Object:
    item = bpy.data.objects.new(name, None)
    bpy.context.scene.collection.objects.link(item)
    item.rotation_mode = mode
    item.select_set(True)
    bpy.context.view_layer.objects.active = item
    for frame, location, axis, degrees in poses:
        key(item, frame, location, Quaternion(axis, np.radians(degrees)))
    return item


def key(item: bpy.types.Object | bpy.types.PoseBone, frame: float, location: tuple, turn: Quaternion) -> None:
    item.location = location
    path = keyframes.PATHS.get(item.rotation_mode, "rotation_euler")
    if item.rotation_mode == "QUATERNION":
        item.rotation_quaternion = turn
    elif item.rotation_mode == "AXIS_ANGLE":
        axis, angle = turn.to_axis_angle()
        item.rotation_axis_angle = (angle, *axis)
    else:
        item.rotation_euler = turn.to_euler(item.rotation_mode, item.rotation_euler)
    item.keyframe_insert("location", frame=frame)
    item.keyframe_insert(path, frame=frame)


def played(item: bpy.types.Object, frames: np.ndarray) -> np.ndarray:
    """Motors of what Blender itself shows at frames, through its own evaluation."""
    matrices = []
    for frame in frames:
        bpy.context.scene.frame_set(int(frame), subframe=float(frame) % 1)
        matrices.append(np.array(item.matrix_basis))
    return FORMS["dual_quaternion"].encode(np.array(matrices, dtype=np.float64))


@pytest.mark.parametrize("mode", MODES)
def test_curves_are_read_as_blender_plays_them(mode):
    item = keyed(mode)
    frames = np.arange(1.0, 90.0, 3.5)
    distance, angle = pose_errors(read_motors(item, frames), played(item, frames))
    assert distance.max() < 1e-6
    assert angle.max() < 2e-6


@pytest.mark.parametrize("mode", MODES)
def test_interpolation_follows_the_screws(mode):
    item = keyed(mode)
    times = key_times(item)
    wanted = rebuild(np.arange(1.0, 91.0), times, played(item, times))
    report = interpolate_with_motors(item, Tolerance(0.1, 0.05))
    distance, angle = pose_errors(played(item, np.arange(1.0, 91.0)), wanted)
    assert distance.max() < 0.1e-3 + 2e-6
    assert np.degrees(angle.max()) < 0.05 + 1e-3
    assert report.millimetres == pytest.approx(distance.max() * 1e3, abs=2e-3)
    assert report.keys_after == key_count(item) < 90 * 6
    np.testing.assert_array_equal(np.isin(times, key_times(item)), True)


@pytest.mark.parametrize("mode", MODES)
def test_reduction_keeps_the_motion(mode):
    item = keyed(mode)
    interpolate_with_motors(item, Tolerance(0.1, 0.05))
    frames = np.arange(1.0, 91.0)
    wanted = played(item, frames)
    for frame, motor in zip(frames, FORMS["dual_quaternion"].decode(wanted), strict=True):  # a dense recording
        location, turn, _ = Matrix(motor).decompose()
        key(item, frame, tuple(location), turn)
    dense = key_count(item)
    report = reduce_item_keyframes(item, Tolerance(1.0, 0.2))
    distance, angle = pose_errors(played(item, frames), wanted)
    assert distance.max() < 1.0e-3 + 2e-6
    assert np.degrees(angle.max()) < 0.2 + 1e-3
    assert report.keys_before == dense
    assert report.keys_after == key_count(item) < 0.35 * dense


def test_channels_that_do_not_change_keep_one_key():
    item = keyed(poses=[(1, (1, 0, 0), (0, 0, 1), 0), (31, (1, 0, 0), (0, 0, 1), 60), (61, (1, 0, 0), (0, 0, 1), 120)])
    frames = np.arange(1.0, 62.0)
    wanted = read_motors(item, frames)
    keyframes.write_motors(item, frames, wanted)
    reduce_item_keyframes(item, Tolerance(1.0, 0.2))
    counts = {(c.data_path, c.array_index): len(c.keyframe_points) for c in keyframes.curves_of(item)}
    still = [("location", i) for i in range(3)] + [("rotation_quaternion", i) for i in (1, 2)]
    assert [counts[channel] for channel in still] == [1] * 5
    assert np.degrees(pose_errors(played(item, frames), wanted)[1].max()) < 0.2 + 1e-3


def test_a_motion_without_spare_keys_stays_as_it_is():
    item = keyed(poses=[(1, (0, 0, 0), (0, 0, 1), 0), (11, (3, 0, 0), (0, 0, 1), 0)])
    for curve in keyframes.curves_of(item):
        for point in curve.keyframe_points:
            point.interpolation = "ELASTIC"
    before = keyframes.save_keys(item)
    report = reduce_item_keyframes(item, Tolerance(0.01, 0.01))
    assert not report.changed
    for (*_, old), (*_, new) in zip(before, keyframes.save_keys(item), strict=True):
        for name in old:
            np.testing.assert_array_equal(old[name], new[name])


def test_tolerance_is_in_metres_of_the_scene():
    fine, coarse = keyed(name="Fine"), keyed(name="Coarse")
    assert interpolate_with_motors(fine, Tolerance(0.1, 1.0)).keys_after > (
        interpolate_with_motors(coarse, Tolerance(0.1, 1.0, metres=0.001)).keys_after
    )


def test_missing_channels_appear_only_where_they_are_needed():
    item = keyed(poses=[])
    for frame, x in ((1, 0.0), (20, 2.0), (30, 5.0)):
        item.location.x = x
        item.keyframe_insert("location", index=0, frame=frame)
    interpolate_with_motors(item, Tolerance(0.1, 0.1))
    assert [(c.data_path, c.array_index) for c in keyframes.curves_of(item)] == [("location", 0)]


def test_bones_move_on_screws_too():
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    bone = rig.data.edit_bones.new("Arm")
    bone.tail = (0.0, 0.0, 1.0)
    bpy.ops.object.mode_set(mode="POSE")
    arm = rig.pose.bones["Arm"]
    arm.rotation_mode = "QUATERNION"
    for frame, location, axis, degrees in POSES:
        key(arm, frame, location, Quaternion(axis, np.radians(degrees)))
    times = key_times(arm)
    wanted = rebuild(np.arange(1.0, 91.0), times, played(arm, times))
    interpolate_with_motors(arm, Tolerance(0.1, 0.05))
    distance, _ = pose_errors(played(arm, np.arange(1.0, 91.0)), wanted)
    assert distance.max() < 0.1e-3 + 2e-6
    assert len(microscope.drawn_paths(arm, 10.0, 0.5)) == len(PATH_NAMES)
    bpy.ops.object.mode_set(mode="OBJECT")


def test_what_cannot_be_used_is_said_and_left_alone():
    still = keyed(poses=[])
    with pytest.raises(UniSGError, match="insert keys"):
        interpolate_with_motors(still, Tolerance(1, 1))
    with pytest.raises(UniSGError, match="one frame"):
        reduce_item_keyframes(keyed(poses=POSES[:1]), Tolerance(1, 1))
    noisy = keyed()
    next(iter(keyframes.curves_of(noisy))).modifiers.new("NOISE")
    count = key_count(noisy)
    with pytest.raises(UniSGError, match="modifiers"):
        reduce_item_keyframes(noisy, Tolerance(1, 1))
    assert key_count(noisy) == count


def test_operators(extension):
    first, second = keyed("XYZ", name="One"), keyed(name="Two")
    first.select_set(True)
    assert bpy.ops.unisg.interpolate_motors(millimetres=0.5, degrees=0.1) == {"FINISHED"}
    counts = key_count(first), key_count(second)
    assert bpy.ops.unisg.reduce_keyframes(millimetres=50.0, degrees=5.0) == {"FINISHED"}
    assert (key_count(first), key_count(second)) < counts
    bpy.ops.object.select_all(action="DESELECT")
    assert not bpy.ops.unisg.interpolate_motors.poll()
    assert bpy.ops.unisg.copy_form.poll()
    with pytest.raises(RuntimeError, match="no form"):
        bpy.ops.unisg.copy_form(form="nothing")


def test_microscope_switches_on_and_off(extension):
    keyed()
    settings = bpy.context.window_manager.unisg_microscope
    settings.show = True
    assert microscope_of_extension().running()
    settings.show = False
    assert not microscope_of_extension().running()
    settings.show = True  # and the extension's end takes the handlers away: see the fixture


def microscope_of_extension():
    return sys.modules["unisg_extension.unisg_blender.blender.viewport.motion_paths"]


def test_panels_draw_every_form(extension):
    keyed()
    layout = MagicMock()
    layout.panel.side_effect = lambda *args, **options: (MagicMock(), layout)
    panels = sys.modules["unisg_extension.panels"]
    panels.forms.UNISG_PT_forms.draw(SimpleNamespace(layout=layout), bpy.context)
    assert layout.panel.call_count == len(FORMS) + 1
    cells = layout.grid_flow().row().label.call_args_list
    assert len(cells) == sum(form.width for form in FORMS.values()) + 6
    panels.motion.UNISG_PT_motion.draw(SimpleNamespace(layout=layout), bpy.context)


def test_every_form_is_shown_as_the_library_has_it():
    parent = keyed(poses=[], name="Parent")
    child = keyed(poses=[], name="Child")
    child.parent = parent
    child.matrix_parent_inverse = Matrix.Translation((0, 0, 1)) @ Matrix.Rotation(0.3, 4, "X")
    child.location, child.scale = (1, 2, 3), (1, 2, -0.5)
    bpy.context.view_layer.update()
    rows = transform_forms(child)
    assert list(rows) == [*FORMS, "stretch"]
    local = np.array(child.matrix_local, dtype=np.float64)
    for name, form in FORMS.items():
        assert [channel for channel, _ in rows[name]] == list(form.channels)
        np.testing.assert_allclose([value for _, value in rows[name]], form.encode(local), atol=2e-6)
    text = json.loads(transform_text(child, "pga"))
    assert text["form"] == "pga"
    assert text["values"] == [value for _, value in rows["pga"]]


def test_microscope_draws_every_path_between_the_keys_around_the_frame():
    item = keyed()
    item.scale = (1, 2, 1)
    bpy.context.view_layer.update()
    paths = microscope.drawn_paths(item, 50.0, 0.0)
    assert [path.name for path in paths] == list(PATH_NAMES)
    for path in paths:
        np.testing.assert_allclose(path.points[[0, -1]], [POSES[1][1], POSES[2][1]], atol=1e-6)
        assert path.axes.shape[1] == 3
        assert len(path.axes) % 6 == 0
    apart = microscope.drawn_paths(item, 50.0, 1.0)
    gaps = [path.points[0, 2] - paths[0].points[0, 2] for path in apart]
    assert (np.diff(gaps) > 0.1).all()
    assert microscope.drawn_paths(keyed(poses=[]), 1.0, 0.0) == []


def test_paths_show_what_forms_do():
    half = np.diag([-1.0, -1.0, 1.0, 1.0])  # a half turn about Z
    start = np.eye(4)
    start[:3, 3] = half[:3, 3] = [1.0, 0.0, 0.0]
    half[:3, 3] = [-1.0, 0.0, 0.0]
    paths = compare_paths(start, half, 21)
    middle = {name: path[10] for name, path in paths.items()}
    np.testing.assert_allclose(middle["matrix"][:2, :2], 0.0, atol=1e-12)  # flattened
    np.testing.assert_allclose(middle["quaternion"][:3, 3], 0.0, atol=1e-12)  # through the middle
    np.testing.assert_allclose(np.linalg.norm(paths["motor"][:, :3, 3], axis=1), 1.0, atol=1e-12)  # round it
    turned = middle["quaternion"][:3, :3].T @ middle["quaternion, other sign"][:3, :3]
    np.testing.assert_allclose(turned, np.diag([-1.0, -1.0, 1.0]), atol=1e-12)  # the two ways round
    for path in paths.values():
        np.testing.assert_allclose(path[[0, -1]], [start, half], atol=1e-12)

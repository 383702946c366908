"""A whole room by one click: at the cursor, in a collection, with its lesson, a camera and a light."""

from __future__ import annotations

import numpy as np
import pytest

bpy = pytest.importorskip("bpy")

from unisg_blender.behaviour import all_actions  # noqa: E402
from unisg_blender.blender import read_scene  # noqa: E402
from unisg_blender.spatial import room_outline  # noqa: E402
from unisg_blender.worlds import operating_room  # noqa: E402

pytestmark = pytest.mark.usefixtures("extension", "fresh_file")


def test_an_operating_room_comes_at_the_cursor_with_its_lesson() -> None:
    bpy.context.scene.cursor.location = (10, -4, 0.5)
    assert bpy.ops.unisg.add_room(kind="operating-room", seed=4) == {"FINISHED"}
    graph, plain = read_scene(), operating_room(4)
    assert len(graph) == len(plain) + 2
    np.testing.assert_allclose(room_outline(graph), room_outline(plain) + np.array([10, -4]), atol=1e-5)
    assert len(all_actions(graph)) == len(all_actions(plain))
    assert [item.name for item in bpy.context.scene.collection.children] == ["Operating Room"]
    assert not len(bpy.context.scene.collection.objects)
    camera = bpy.context.scene.camera
    low, high = room_outline(graph).min(axis=0), room_outline(graph).max(axis=0)
    assert (np.array(camera.location[:2]) > low).all()
    assert (np.array(camera.location[:2]) < high).all()
    assert camera.location.z == pytest.approx(2.4, abs=1e-5)


def test_the_same_room_twice_is_two() -> None:
    for _ in range(2):
        bpy.ops.unisg.add_room(kind="living-room", seed=2, with_view=False)
    graph = read_scene(geometry="none")
    stored = [item["unisg_uid"] for item in bpy.context.scene.objects if "unisg_uid" in item]
    assert len(set(stored)) == len(stored) == len(graph)


def test_another_room_each_time_in_the_scenes_unit() -> None:
    bpy.context.scene.unit_settings.scale_length = 0.01
    bpy.ops.unisg.add_room(kind="living-room", with_view=True)
    size = np.ptp(room_outline(read_scene()), axis=0)
    assert (size > 2).all()
    assert bpy.context.scene.camera.location.z == pytest.approx(190, abs=0.1)
    assert not bpy.context.selected_objects

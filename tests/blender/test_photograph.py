"""Pictures are taken in the scene's own light, and where that shows nothing, with a lamp, which is said."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("bpy")

import bpy

from tests.blender.helpers import add, box
from unisg_blender.blender.render.photograph import Photographer
from unisg_blender.blender.render.picture_faults import picture_fault
from unisg_blender.geometry.camera_view import CameraView, looking


def view(name: str, *place: float) -> CameraView:
    """From a place to the middle of the world."""
    return looking(name, np.array(place), np.zeros(3), (24, 16), 1.2)


def sky(color: float, strength: float = 1.0) -> None:
    """Give the scene a plain sky."""
    world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (color, color, color, 1)
    background.inputs["Strength"].default_value = strength
    bpy.context.scene.world = world


def shining(strength: float) -> None:
    """Give a new material a light of its own."""
    material = bpy.data.materials.new("shining")
    material.use_nodes = True
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Emission Strength"].default_value = strength


def photographer() -> Photographer:
    return Photographer(bpy.context.scene, "cycles", 1, 1)


@pytest.mark.parametrize(
    ("color", "strength", "emitted", "lit"),
    [(0.0509, 1.0, 0.0, False), (0.0, 9.0, 0.0, False), (0.05, 9.0, 0.0, True), (0.8, 1.0, 0.0, True), (0, 1, 2, True)],
)
def test_what_lights_a_scene(color: float, strength: float, emitted: float, lit: bool) -> None:
    """A plain sky as Blender gives to every new scene does not."""
    add("Thing", box())
    sky(color, strength)
    shining(emitted)
    assert bool(photographer().note) != lit


def test_what_its_own_light_leaves_black_is_taken_with_a_lamp(tmp_path: Path) -> None:
    room, thing, lamp = add("Room", box(size=8.0)), add("Thing", box()), add("Sun", bpy.data.lights.new("Sun", "SUN"))
    sky(0.0)
    lamp.location = (0, 0, 9)
    taker = photographer()
    for name, place in (("inside", (2.0, -2.5, 1.0)), ("outside", (9.0, -9.0, 9.0))):
        taker.take(view(name, *place), tmp_path / f"{name}.png")
        assert not picture_fault(tmp_path / f"{name}.png")
    assert taker.note == "black by the scene's own light, and taken with a lamp: inside"
    assert set(bpy.context.scene.objects) == {room, thing, lamp}


def test_a_picture_of_nothing_is_told(tmp_path: Path) -> None:
    add("Thing", box())
    taker = photographer()
    away = looking("away", np.array([0, -9.0, 0]), np.array([0, -20.0, 0]), (24, 16), 1.2)
    taker.take(away, tmp_path / "away.png")
    assert taker.note.endswith("; nothing is to be seen in away")

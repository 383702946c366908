"""Rigid bodies of Blender's scenes are read, and written back."""

from __future__ import annotations

import pytest

bpy = pytest.importorskip("bpy")

from tests.metrics.hand_made import Scene  # noqa: E402
from unisg_blender.blender import new_file, read_scene, write_scene  # noqa: E402
from unisg_blender.scene import SceneGraph  # noqa: E402
from unisg_blender.scene.components import RIGID_BODIES  # noqa: E402
from unisg_blender.spatial.bodies import simulated_scene  # noqa: E402

COLUMNS = ("kind", "shape", "mass", "friction", "restitution")


def bodies(graph: SceneGraph) -> dict[str, tuple]:
    return {graph.name[row]: tuple(values) for row, *values in graph.entries(RIGID_BODIES, *COLUMNS)}


def test_bodies_go_there_and_back() -> None:
    new_file()
    scene = Scene()
    scene.box("crate", (1, 1, 1), (0, 0, 0), category="Box")
    graph = simulated_scene(scene.build(), "box")
    made = write_scene(graph)
    crate = next(item for item in made.objects if item.name == "crate")
    assert (crate.rigid_body.type, crate.rigid_body.collision_shape) == ("ACTIVE", "BOX")
    assert crate.rigid_body.mass == pytest.approx(250)
    again = bodies(read_scene(made))
    assert again.keys() == {"crate", "floor"}
    assert again["crate"][:2] == ("active", "box")
    assert again["crate"][2:] == pytest.approx((250, 0.7, 0.0), rel=1e-6)
    assert again["floor"][:2] == ("passive", "mesh")


def test_what_is_moved_by_keys_is_passive() -> None:
    new_file()
    made = write_scene(simulated_scene(one_box()))
    crate = next(item for item in made.objects if item.name == "crate")
    crate.rigid_body.kinematic = True
    found = {name: values[0] for name, values in bodies(read_scene(made)).items()}
    assert found == {"crate": "passive", "floor": "passive"}


def one_box() -> SceneGraph:
    scene = Scene()
    scene.box("crate", (1, 1, 1), (0, 0, 0), category="Box")
    return scene.build()

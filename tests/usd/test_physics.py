"""Rigid bodies in USD: what simulators find, what is read back, what other tools say; categories as labels."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.metrics.hand_made import Scene, box_mesh
from unisg_blender.cli import main
from unisg_blender.errors import UniSGError
from unisg_blender.formats.scene_files import read_scene_file, write_scene_file
from unisg_blender.scene import SceneGraph
from unisg_blender.scene.components import RIGID_BODIES
from unisg_blender.spatial.bodies import simulated_scene
from unisg_blender.usd.pxr_library import require_pxr

require_pxr()
from pxr import Usd  # noqa: E402


def room() -> SceneGraph:
    scene = Scene()
    table = scene.box("table", (1, 1, 0.7), (0, 0, 0), category="Table")
    scene.box("cup", (0.1, 0.1, 0.1), (0, 0, 0.7), parent=table, category="Cup", relation=("on_top_of", "table"))
    scene.box("bag", (0.1, 0.1, 0.1), (0.55, 0, 0.5), parent=table, category="Bag", relation=("hangs_from", "table"))
    return scene.build()


def bodies(graph: SceneGraph) -> dict[str, tuple[str, str, float]]:
    names = ("kind", "shape", "mass")
    return {graph.name[row]: tuple(rest) for row, *rest in graph.entries(RIGID_BODIES, *names)}


def test_things_move_the_building_does_not_and_nothing_else_changes() -> None:
    before, after = room(), simulated_scene(room(), "box")
    found = bodies(after)
    assert found["floor"][:2] == ("passive", "mesh")
    assert {name: found[name][:2] for name in ("table", "cup")} == {
        "table": ("active", "box"),
        "cup": ("active", "box"),
    }
    assert "bag" not in found  # it is of the table's body
    assert found["table"][2] == pytest.approx(250 * 0.7 + 250 * 0.001)
    for name in before.name:
        assert np.allclose(after.world[after.row(name)], before.world[before.row(name)])
    parents = {after.name[row]: after.parent[row] for row in range(len(after))}
    assert (parents["cup"], parents["table"], parents["bag"]) == (-1, -1, after.row("table"))
    assert simulated_scene(after, "hull") is after
    with pytest.raises(UniSGError, match="box, hull, mesh"):
        simulated_scene(before, "ball")


def test_simulators_find_bodies_colliders_masses_and_labels(tmp_path: Path) -> None:
    path = tmp_path / "room.usda"
    write_scene_file(simulated_scene(room(), "hull"), path)
    stage = Usd.Stage.Open(str(path))
    found = {prim.GetName(): prim for prim in stage.Traverse() if prim.GetTypeName() == "Xform"}
    table, mesh = found["table"], found["table"].GetChild("table")
    assert {"PhysicsRigidBodyAPI", "PhysicsMassAPI"} <= set(table.GetAppliedSchemas())
    assert "PhysicsRigidBodyAPI" not in found["floor"].GetAppliedSchemas()
    assert {"PhysicsCollisionAPI", "PhysicsMeshCollisionAPI"} <= set(mesh.GetAppliedSchemas())
    assert mesh.GetAttribute("physics:approximation").Get() == "convexHull"
    assert found["floor"].GetChild("floor").GetAttribute("physics:approximation").Get() == "none"
    assert table.GetAttribute("physics:mass").Get() == pytest.approx(175.25)
    assert list(table.GetAttribute("semantics:labels:category").Get()) == ["Table"]
    assert "SemanticsLabelsAPI:category" in table.GetAppliedSchemas()
    assert stage.GetMetadata("kilogramsPerUnit") == 1.0
    nested = [prim for prim in stage.Traverse() if "PhysicsRigidBodyAPI" in prim.GetParent().GetAppliedSchemas()]
    assert not [prim for prim in nested if "PhysicsRigidBodyAPI" in prim.GetAppliedSchemas()]


@pytest.mark.parametrize("ending", [".usda", ".usdc", ".json"])
def test_bodies_come_back(tmp_path: Path, ending: str) -> None:
    graph = simulated_scene(room(), "box")
    write_scene_file(graph, tmp_path / f"room{ending}")
    assert bodies(read_scene_file(tmp_path / f"room{ending}")[0]) == bodies(graph)


FOREIGN = """#usda 1.0
(
    kilogramsPerUnit = 0.001
    upAxis = "Z"
    metersPerUnit = 1
)
def Xform "crate" (
    prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]
) {
    float physics:mass = 2500
    def Cube "shape" (
        prepend apiSchemas = ["PhysicsCollisionAPI", "PhysicsMeshCollisionAPI"]
    ) {
        double size = 0.5
        uniform token physics:approximation = "boundingCube"
        double3 xformOp:translate = (0, 0, 1)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
}
def Cube "ground" (
    prepend apiSchemas = ["PhysicsCollisionAPI", "SemanticsLabelsAPI:category"]
) {
    double size = 4
    token[] semantics:labels:category = ["Floor", "Ground"]
}
"""


def test_bodies_of_other_tools_are_read(tmp_path: Path) -> None:
    path = tmp_path / "foreign.usda"
    path.write_text(FOREIGN, "utf-8")
    graph, lost = read_scene_file(path)
    assert bodies(graph) == {"crate": ("active", "box", 2.5), "ground": ("passive", "mesh", 0.0)}
    assert graph["ground"].category == "Floor"
    assert not list(lost)


def test_the_command_line_makes_bodies(tmp_path: Path, capsys) -> None:
    write_scene_file(room(), tmp_path / "room.json")
    assert main(["convert", str(tmp_path / "room.json"), str(tmp_path / "room.usda"), "--physics", "hull", "-q"]) == 0
    assert bodies(read_scene_file(tmp_path / "room.usda")[0])["cup"][:2] == ("active", "hull")
    assert main(["convert", str(tmp_path / "room.json"), str(tmp_path / "b.usda"), "--physics", "jelly"]) == 1
    assert "give one of box, hull, mesh" in capsys.readouterr().err
    assert not (tmp_path / "b.usda").exists()


def test_a_flat_body_has_a_mass() -> None:
    scene = Scene()
    scene.box("sheet", None, (0, 0, 0), mesh=box_mesh(((1, 1, 0), (0, 0, 0))), category="Drape")
    assert bodies(simulated_scene(scene.build()))["sheet"][2] == pytest.approx(0.3)

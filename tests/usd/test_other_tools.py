"""Files of other tools open as they look there; what we write looks the same in Blender and passes USD's own checks."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.conftest import scene_files
from tests.usd.test_edits import studio
from unisg_blender.scene import SceneBuilder, SceneGraph, mesh_from_faces, table, world_matrices
from unisg_blender.spatial.bodies import simulated_scene
from unisg_blender.usd import read_usd, write_usd
from unisg_blender.usd.pxr_library import require_pxr
from unisg_blender.worlds import operating_room

DATA = Path(__file__).parents[1] / "data"
OTHERS = sorted(
    [path for path in (DATA / "usd-wg-assets").rglob("*.usda")]
    + [path for path in scene_files() if path.suffix.startswith(".usd")]
)
CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 2) for z in (0, 3)], float)
BOX = mesh_from_faces(
    "Box", CORNERS, [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
)


def boxes(graph: SceneGraph, base: np.ndarray | None = None) -> np.ndarray:
    """Axis-aligned world boxes (K, 6) of all geometry, instances included."""
    world = world_matrices(graph) if base is None else base @ world_matrices(graph)
    found = []
    for row in np.flatnonzero(graph.mesh >= 0):
        points = graph.meshes[graph.mesh[row]].points @ world[row, :3, :3].T + world[row, :3, 3]
        found += [np.concatenate([points.min(axis=0), points.max(axis=0)])] if len(points) else []
    instances = graph.components.get("instances")
    if instances is not None:
        for row, prototype, matrix in zip(
            instances.rows, instances.columns["prototype"], instances.columns["matrix"], strict=True
        ):
            found += list(boxes(prototype, world[row] @ matrix))
    return np.array(found).reshape(-1, 6)


def blender_boxes(path: Path) -> np.ndarray:
    """The same after Blender's own importer."""
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    plain = {} if bpy.app.version >= (5, 0, 0) else {"import_subdiv": False}
    bpy.ops.wm.usd_import(filepath=str(path), import_visible_only=False, **plain)
    found = []
    for instance in bpy.context.evaluated_depsgraph_get().object_instances:
        item = instance.object
        if item.type == "MESH" and len(item.data.vertices):
            points = np.empty(len(item.data.vertices) * 3, np.float32)
            item.data.vertices.foreach_get("co", points)
            matrix = np.array(instance.matrix_world)
            points = points.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]
            found.append(np.concatenate([points.min(axis=0), points.max(axis=0)]))
    return np.array(found).reshape(-1, 6)


def stage_boxes(path: Path) -> np.ndarray:
    """The same after USD's own bounding boxes of points, in metres and Z up."""
    require_pxr()
    from pxr import Gf, Usd, UsdGeom, UsdSkel

    from unisg_blender.usd.read.stage import stage_frame

    stage = Usd.Stage.Open(str(path))
    stage.SetEditTarget(stage.GetSessionLayer())
    UsdSkel.BakeSkinning(stage.Traverse(), Gf.Interval(stage.GetStartTimeCode(), stage.GetStartTimeCode()))
    frame, cache, found = stage_frame(stage), UsdGeom.XformCache(), []
    for prim in stage.Traverse(Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)):
        if prim.IsA(UsdGeom.Mesh) and UsdGeom.Imageable(prim).ComputePurpose() in ("default", "render"):
            points = UsdGeom.Mesh(prim).GetPointsAttr().Get(Usd.TimeCode.EarliestTime())
            points = np.array([] if points is None else points).reshape(-1, 3)
            matrix = frame @ np.array(cache.GetLocalToWorldTransform(prim)).T
            points = points @ matrix[:3, :3].T + matrix[:3, 3]
            found += [np.concatenate([points.min(axis=0), points.max(axis=0)])] if len(points) else []
    return np.array(found).reshape(-1, 6)


def assert_same_boxes(found: np.ndarray, expected: np.ndarray) -> None:
    """Every box has a partner on the other side, to 1e-5 of its farthest corner."""
    assert len(found) == len(expected)
    if len(found):
        size = np.maximum(np.abs(expected).max(axis=1), 1e-6)
        gap = np.abs(found[:, None] - expected[None]).max(axis=2) / size
        assert gap.min(axis=1).max() < 1e-5
        assert gap.min(axis=0).max() < 1e-5


@pytest.mark.parametrize("path", OTHERS, ids=[f"{path.parent.name}/{path.name}" for path in OTHERS])
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_scenes_of_others(path: Path, tmp_path: Path) -> None:
    """The geometry stands where USD puts it, and still does after a round trip."""
    graph = read_usd(path)
    found = boxes(graph)
    expected = stage_boxes(path)
    if len(expected) == len(found):  # cubes, spheres and curves are no meshes in USD
        assert_same_boxes(found, expected)
    else:
        assert len(found) > len(expected)
    write_usd(graph, tmp_path / "again.usdc")
    again = read_usd(tmp_path / "again.usdc")
    assert again.name == graph.name
    assert_same_boxes(boxes(again), found)


def trs_scene() -> SceneGraph:
    """Hierarchies without shear (Blender's importer cannot hold it): mirrored, scaled, shared, instanced, moved."""
    rng = np.random.default_rng(0)

    def pose(scale: bool = True) -> np.ndarray:
        matrix = np.eye(4)
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        size = rng.uniform(0.3, 2, 3) * rng.choice([-1, 1], 3) if scale else np.ones(3)
        matrix[:3, :3] = turn * np.sign(np.linalg.det(turn)) * size
        matrix[:3, 3] = rng.normal(size=3)
        return matrix

    builder = SceneBuilder("Room")
    for number in range(12):
        parent = int(rng.integers(-1, number)) if number else -1
        builder.add(f"Thing {number}", uid=f"t{number}", parent=parent, local=pose(), mesh=[BOX, None][number % 3 == 2])
    holder = builder.add("Holder", uid="holder", local=pose())
    moved = builder.add("Moved", uid="moved", parent=builder.add("Still", uid="still", local=pose(False)), mesh=BOX)
    assert holder != moved
    graph = builder.build()
    inner = SceneBuilder("Prototype")
    inner.add("Inner", uid="inner", local=pose(), mesh=BOX)
    many = np.tile(np.eye(4), (12, 1, 1))
    many[:, :3, 3] = rng.normal(size=(12, 3))
    placed = np.concatenate([np.stack([pose(), pose()]), many])
    rows = [graph.row("Holder")] * len(placed)
    sources = ["COLLECTION"] * 2 + ["GEOMETRY"] * 12
    graph = graph.with_component(
        "instances", table(rows, prototype=[inner.build()] * len(rows), matrix=placed, source=sources)
    )
    return graph.with_component("world", table([graph.row("Moved")], matrix=pose(False)[None]))


@pytest.mark.parametrize("ending", ["usda", "usdc", "usdz"])
def test_blender_shows_what_we_write(tmp_path: Path, ending: str) -> None:
    pytest.importorskip("bpy")
    path = tmp_path / f"scene.{ending}"
    graph = trs_scene()
    write_usd(graph, path)
    assert_same_boxes(blender_boxes(path), boxes(graph))


@pytest.mark.slow
def test_usd_checker_passes(tmp_path: Path) -> None:
    """With USD's checker of the running build, and in a process of its own with the other build."""
    path = tmp_path / "scene.usda"
    write_usd(trs_scene(), path)
    write_usd(trs_scene(), tmp_path / "scene.usdz")
    write_usd(studio(), tmp_path / "studio.usda")
    for shape in ("box", "hull", "mesh"):
        write_usd(simulated_scene(operating_room(0), shape), tmp_path / f"bodies-{shape}.usdc")
    script = Path(__file__).with_name("check_compliance.py")
    for build in ("bpy", "usd-core"):
        answer = subprocess.run(
            [sys.executable, str(script), build, *map(str, sorted(tmp_path.iterdir()))],
            capture_output=True, text=True, timeout=120, env=os.environ | {"PYTHONPATH": str(DATA.parents[1])},
        )  # fmt: skip
        if "ModuleNotFoundError" in answer.stderr or "MissingPackageError" in answer.stderr:
            continue
        assert answer.returncode == 0, answer.stdout + answer.stderr
        assert "checked" in answer.stdout


def test_elements() -> None:
    """The paper's own framework: untyped prims, column-vector matrices, Y up."""
    with pytest.warns(UserWarning, match="ID has no value that can be kept|Parent has no value that can be kept"):
        graph = read_usd(DATA / "elements" / "ExampleScene.usd")
    assert graph.name[graph.parent[graph.row("Cube_Test")]] == "cube"
    assert graph["cube"].parent.name == "RooT"
    cube = graph["Cube_Test"]
    np.testing.assert_allclose(cube.local[:3, 3], [-1.1, -0.1, 0.7], atol=1e-6)  # (-1.1, 0.7, 0.1) with Y up
    assert len(cube.mesh.points) == 36
    assert (np.diff(cube.mesh.offsets) == 3).all()
    assert graph["Entity_Camera"].mesh is None


Y_UP = """#usda 1.0
(
    upAxis = "Y"
    metersPerUnit = 0.01
    timeCodesPerSecond = 10
)
def Xform "root" {
    def Xform "Lamp" (
        displayName = "Lamp one"
        variants = { string look = "big" }
        prepend variantSets = "look"
    )
    {
        double3 xformOp:translate = (100, 200, 300)
        uniform token[] xformOpOrder = ["xformOp:translate"]
        custom string userProperties:note = "a"
        custom string userProperties:unisg_category = "Lamp"
        def Mesh "Shape" {
            point3f[] points = [(0, 0, 0), (0, 10, 0), (10, 0, 0)]
            int[] faceVertexCounts = [3]
            int[] faceVertexIndices = [0, 1, 2]
            uniform token orientation = "leftHanded"
        }
        variantSet "look" = {
            "big" {
                def Cube "Bulb" {
                    double size = 4
                }
            }
            "small" {
            }
        }
    }
    def Camera "Eye" {
        double3 xformOp:translate = (0, 100, 0)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
    def Xform "Apart" {
        double3 xformOp:translate.timeSamples = { 0: (1, 0, 0), 10: (2, 0, 0) }
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
    def Xform "Free" {
        double3 xformOp:translate = (5, 5, 5)
        uniform token[] xformOpOrder = ["xformOp:translate"]
        def Xform "Reset" {
            double3 xformOp:translate = (1, 2, 3)
            uniform token[] xformOpOrder = ["!resetXformStack!", "xformOp:translate"]
        }
    }
    def PointInstancer "Grass" {
        int[] protoIndices = [0, 0]
        point3f[] positions = [(0, 0, 0), (100, 0, 0)]
        rel prototypes = </root/Grass/Blade>
        def Sphere "Blade" {
            double radius = 50
        }
    }
    def Scope "Materials" {
        def Material "Red" {
        }
    }
}
"""


@pytest.mark.filterwarnings("ignore:only the selected variants are read|subdivision .* is not read:UserWarning")
def test_y_up_centimetres_variants_samples_and_instancers(tmp_path: Path) -> None:
    (tmp_path / "y.usda").write_text(Y_UP)
    graph = read_usd(tmp_path / "y.usda")
    world = world_matrices(graph)
    assert "Materials" not in graph.name
    lamp = graph["Lamp one"]
    assert lamp.category == "Lamp"
    np.testing.assert_allclose(world[lamp.row, :3, 3], [1, -3, 2])
    np.testing.assert_allclose(world[lamp.row, :3, :3], np.eye(3), atol=1e-12)
    shape = graph["Shape"].mesh
    np.testing.assert_allclose(shape.points, [[0, 0, 0], [0, 0, 0.1], [0.1, 0, 0]], atol=1e-7)
    assert shape.corners.tolist() == [2, 1, 0]
    np.testing.assert_allclose(np.ptp(graph["Bulb"].mesh.points, axis=0), [0.04] * 3, atol=1e-7)
    eye = world[graph.row("Eye")]
    np.testing.assert_allclose(eye[:3, 3], [0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(eye[:3, :3] @ [0, 0, -1], [0, 1, 0], atol=1e-12)  # it looks along USD's -Z, our +Y
    moving = graph["Apart"].component("animation")
    np.testing.assert_allclose(moving["times"][0], [0, 1])
    np.testing.assert_allclose(moving["matrices"][0][:, 0, 3], [0.01, 0.02])
    np.testing.assert_allclose(world[graph.row("Reset"), :3, 3], [0.01, -0.03, 0.02], atol=1e-12)
    blades = graph["Grass"].component("instances")
    assert blades["prototype"][0] is blades["prototype"][1]
    np.testing.assert_allclose(blades["matrix"][1][:3, 3], [1, 0, 0], atol=1e-12)
    np.testing.assert_allclose(np.ptp(blades["prototype"][0].meshes[0].points, axis=0), [1, 1, 1], atol=1e-6)


def test_native_instances_and_references_share_meshes(tmp_path: Path) -> None:
    arrays = (
        "point3f[] points = [(0,0,0),(1,0,0),(0,1,0)]\nint[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0,1,2]"
    )
    asset = f'def Xform "Chair" {{\ndef Mesh "Seat" {{\n{arrays}\n}}\n}}\n'
    (tmp_path / "chair.usda").write_text('#usda 1.0\n(\ndefaultPrim = "Chair"\n)\n' + asset)
    copies = "".join(
        f'def "{name}" (\n{extra}\nprepend {arc} = @./chair.usda@\n) {{\n}}\n'
        for name, extra, arc in (
            ("One", "instanceable = true", "references"), ("Two", "instanceable = true", "references"),
            ("Three", "", "references"), ("Four", "", "payload"),
        )
    )  # fmt: skip
    (tmp_path / "room.usda").write_text('#usda 1.0\n(\nupAxis = "Z"\nmetersPerUnit = 1\n)\n' + copies)
    with pytest.warns(UserWarning, match="subdivision .* is not read: /One/Seat, /Two/Seat"):
        graph = read_usd(tmp_path / "room.usda")
    assert graph.name == ("Four", "One", "Three", "Two")
    assert (graph.mesh >= 0).all()
    assert graph.mesh[1] == graph.mesh[3]
    assert graph.mesh[0] == graph.mesh[2]

"""Skinned meshes of other tools are read as their skeleton poses them at the first frame."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest

from unisg_blender.scene import realize, world_matrices
from unisg_blender.usd import read_usd

RIG = """#usda 1.0
(
    defaultPrim = "Root"
    metersPerUnit = 1
    upAxis = "Z"
    startTimeCode = 10
    endTimeCode = 20
)
def SkelRoot "Root"
{
    def Skeleton "Skeleton" (prepend apiSchemas = ["SkelBindingAPI"])
    {
        uniform token[] joints = ["a", "a/b"]
        uniform matrix4d[] bindTransforms = [UNIT, UNIT]
        uniform matrix4d[] restTransforms = [UNIT, UNIT]
        rel skel:animationSource = </Root/Skeleton/Animation>
        def SkelAnimation "Animation"
        {
            uniform token[] joints = ["a", "a/b"]
            float3[] translations.timeSamples = { 10: [(0, 0, 0), (0, 0, 5)], 20: [(0, 0, 0), (0, 0, 9)] }
            quatf[] rotations = [(1, 0, 0, 0), (1, 0, 0, 0)]
            half3[] scales = [(1, 1, 1), (1, 1, 1)]
        }
    }
    def Mesh "Skin" (prepend apiSchemas = ["SkelBindingAPI"])
    {
        point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
        int[] faceVertexCounts = [3]
        int[] faceVertexIndices = [0, 1, 2]
        uniform token subdivisionScheme = "none"
        rel skel:skeleton = </Root/Skeleton>
        int[] primvars:skel:jointIndices = [0, 1, 1] (
            elementSize = 1
            interpolation = "vertex"
        )
        float[] primvars:skel:jointWeights = [1, 1, 1] (
            elementSize = 1
            interpolation = "vertex"
        )
    }
}
""".replace("UNIT", "((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))")


@pytest.mark.parametrize(("joints", "heights"), [("[0, 1, 1]", [0, 5, 5]), ("[0, 1, 99]", [0, 0, 0])])
def test_a_skinned_mesh_has_its_first_pose(tmp_path: Path, joints: str, heights: list[float]) -> None:
    """Joints that are not there cannot move anything: the mesh is read as it is modelled, which is told."""
    path = tmp_path / "rig.usda"
    path.write_text(RIG.replace("[0, 1, 1]", joints))
    before = path.read_bytes()
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        graph = read_usd(path)
    np.testing.assert_allclose(graph["Skin"].mesh.points[:, 2], heights, atol=1e-6)
    assert [each for each in told if "skinning and blend shapes: only the first pose is kept" in str(each.message)]
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    ("start", "height"), [("startTimeCode = 5", 5), ("startTimeCode = 15", 7), ("startTimeCode = 30", 9), ("", 5)]
)
def test_the_first_pose_may_lie_between_samples_or_beyond(tmp_path: Path, start: str, height: float) -> None:
    end = "endTimeCode = 40" if start else ""
    (tmp_path / "rig.usda").write_text(RIG.replace("startTimeCode = 10", start).replace("endTimeCode = 20", end))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of later poses
        graph = read_usd(tmp_path / "rig.usda")
    np.testing.assert_allclose(graph["Skin"].mesh.points[:, 2], [0, height, height], atol=1e-6)


def instances(tmp_path: Path, nested: bool) -> Path:
    """Two native instances of the rig, also within native instances."""
    (tmp_path / "rig.usda").write_text(RIG)
    place = "(\n prepend references = @{0}@\n instanceable = true\n)\n{{\n double3 xformOp:translate = ({1}, 0, 0)\n"
    place += ' uniform token[] xformOpOrder = ["xformOp:translate"]\n}}\n'
    head = '#usda 1.0\n(\n defaultPrim = "Two"\n startTimeCode = 10\n upAxis = "Z"\n metersPerUnit = 1\n)\n'
    head += 'def Xform "Two"\n{\n'
    two = [f'def "{name}" {place.format("rig.usda", x)}' for name, x in (("A", 0), ("B", 7))]
    (tmp_path / "two.usda").write_text(head + "".join(two) + "}\n")
    pair = [f'def "{name}" {place.format("two.usda", x)}' for name, x in (("Near", 0), ("Far", 100))]
    (tmp_path / "four.usda").write_text(head + "".join(pair) + "}\n")
    return tmp_path / ("four.usda" if nested else "two.usda")


@pytest.mark.parametrize("nested", [False, True])
def test_skinned_meshes_in_native_instances_are_posed(tmp_path: Path, nested: bool) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of later poses
        graph = realize(read_usd(instances(tmp_path, nested)))
    shown = np.flatnonzero(graph.mesh >= 0)
    assert len(shown) == (4 if nested else 2)
    for row in shown:
        np.testing.assert_allclose(graph.meshes[graph.mesh[row]].points[:, 2], [0, 5, 5])
    expected = [0, 7, 100, 107] if nested else [0, 7]
    np.testing.assert_allclose(sorted(world_matrices(graph)[shown, 0, 3]), expected)


def test_very_many_skinned_instances_are_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from unisg_blender.usd.read import skinning

    monkeypatch.setattr(skinning, "MOST_COPIES", 1)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        graph = read_usd(instances(tmp_path, False))
    texts = [str(each.message) for each in told]
    assert "2 instances of skinned meshes are read as they are modelled" in texts
    assert not [text for text in texts if "bakeSkinning" in text]
    assert all(mesh.points[:, 2].tolist() == [0, 0, 0] for mesh in graph.meshes)

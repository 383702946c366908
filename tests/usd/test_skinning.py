"""Skinned meshes of other tools are read as their skeleton poses them at the first frame."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest

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

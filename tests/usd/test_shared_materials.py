"""What references and native instances share, with the materials inside it, stays shared; what differs does not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from unisg_blender.scene import SceneGraph
from unisg_blender.usd import read_usd, write_usd

ASSET = """#usda 1.0
(
    defaultPrim = "World"
    metersPerUnit = 1
    upAxis = "Z"
)
class Xform "Asset"
{
    def Mesh "ball" (
        prepend apiSchemas = ["MaterialBindingAPI"]
    )
    {
        point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
        int[] faceVertexCounts = [3]
        int[] faceVertexIndices = [0, 1, 2]
        uniform token subdivisionScheme = "none"
        rel material:binding = </Asset/look/red>
    }
    def Scope "look"
    {
        def Material "red"
        {
            token outputs:surface.connect = </Asset/look/red/shader.outputs:surface>
            def Shader "shader"
            {
                uniform token info:id = "UsdPreviewSurface"
                color3f inputs:diffuseColor = (1, 0, 0)
                token outputs:surface
            }
        }
    }
}
def Xform "World"
{
"""
BLUE = """over "look"
{
    over "red"
    {
        over "shader"
        {
            color3f inputs:diffuseColor = (0, 0, 1)
        }
    }
}"""


def scene(folder: Path, *copies: tuple[str, str]) -> SceneGraph:
    """Copies of the asset: (metadata, what is in the prim)."""
    prims = [
        f'def Xform "C{number}" (references = </Asset>\n{metadata})\n{{\n{inner}\n}}\n'
        for number, (metadata, inner) in enumerate(copies)
    ]
    path = folder / "scene.usda"
    path.write_text(ASSET + "".join(prims) + "}\n")
    return read_usd(path)


@pytest.mark.parametrize("metadata", ["", "instanceable = true"])
def test_copies_share_mesh_and_material(tmp_path: Path, metadata: str) -> None:
    graph = scene(tmp_path, *[(metadata, "")] * 3)
    assert len(graph.meshes) == 1
    assert {name: material.base_color for name, material in graph.materials.items()} == {"red": (1, 0, 0, 1)}
    assert (graph.mesh >= 0).sum() == 3
    write_usd(graph, tmp_path / "again.usda")
    assert len(read_usd(tmp_path / "again.usda").meshes) == 1


def test_a_copy_with_another_colour_is_another_material(tmp_path: Path) -> None:
    graph = scene(tmp_path, ("", ""), ("", BLUE), ("", BLUE))
    assert [graph[f"C{number}"].mesh.materials for number in range(3)] == [("red",), ("red.001",), ("red.001",)]
    assert len(graph.meshes) == 2
    np.testing.assert_allclose(graph.materials["red.001"].base_color, (0, 0, 1, 1))

"""What a USD file says and a scenegraph cannot hold is told with the prims that lose it; our own files lose nothing."""

from __future__ import annotations

import warnings
from pathlib import Path

import pytest

from tests.usd.test_edits import studio
from tests.usd.test_other_tools import trs_scene
from unisg_blender.usd import read_usd, write_usd

FACE = """
    point3f[] points = [(0,0,0),(1,0,0),(0,1,0)]
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0,1,2]
    uniform token subdivisionScheme = "none"
"""
TEXTURED = """
def Scope "Looks" {
    def Material "Paint" {
        token outputs:surface.connect = </Looks/Paint/shader.outputs:surface>
        def Shader "shader" {
            uniform token info:id = "UsdPreviewSurface"
            color3f inputs:diffuseColor.connect = </Looks/Paint/texture.outputs:rgb>
            color3f inputs:emissiveColor = (1, 0, 0)
            token outputs:surface
        }
        def Shader "texture" {
            uniform token info:id = "UsdUVTexture"
            asset inputs:file = @wood.png@
            float3 outputs:rgb
        }
    }
}
"""


def told(folder: Path, body: str) -> list[str]:
    (folder / "scene.usda").write_text('#usda 1.0\n(\nupAxis = "Z"\nmetersPerUnit = 1\n)\n' + body)
    return told_of(folder / "scene.usda")


def told_of(path: Path) -> list[str]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        read_usd(path)
    return [str(item.message) for item in caught]


@pytest.mark.parametrize("make", [studio, trs_scene])
def test_our_own_files_lose_nothing(tmp_path: Path, make) -> None:
    write_usd(make(), tmp_path / "own.usda")
    assert told_of(tmp_path / "own.usda") == []


def mesh(more: str, schemas: str = "") -> str:
    return f'def Mesh "Thing" ({schemas}) {{\n{FACE}\n{more}\n}}\n'


CASES = {
    "subdivision": (mesh("").replace('"none"', '"catmullClark"'), "subdivision (catmullClark)"),
    "creases": (mesh("int[] creaseIndices = [0, 1]"), "creaseIndices not read"),
    "vertex colours": (mesh("color3f[] primvars:displayColor = [(1, 0, 0)]"), "vertex colours"),
    "other primvars": (mesh("float[] primvars:wear = [1]"), "primvars:wear not read"),
    "skinning": (
        mesh("int[] primvars:skel:jointIndices = [0, 0, 0]", 'prepend apiSchemas = ["SkelBindingAPI"]'), "skinning",
    ),
    "blend shapes": (mesh('uniform token[] skel:blendShapes = ["smile"]'), "blend shapes"),
    "velocities": (mesh("vector3f[] velocities = [(0,0,0),(0,0,0),(0,0,0)]"), "velocities not read"),
    "moving points": (
        mesh("").replace("points =", "points.timeSamples = { 0: [(0,0,0),(1,0,0),(0,1,0)], 1:").replace(
            "1,0)]\n    int[] faceVertexC", "1,0)] }\n    int[] faceVertexC"
        ),
        "points that move",
    ),
    "physics": (mesh("", 'prepend apiSchemas = ["PhysicsArticulationRootAPI"]'), "physics"),
    "point widths": (
        'def Points "Thing" {\npoint3f[] points = [(0,0,0)]\nfloat[] widths = [1]\n}\n', "widths not read",
    ),
    "curves": ('def BasisCurves "Thing" {\npoint3f[] points = [(0,0,0),(1,0,0)]\nint[] curveVertexCounts = [2]\n}\n',
               "curves are read as edges"),
    "volumes": ('def Volume "Thing" {\n}\n', "fields of volumes"),
    "skeletons": ('def Skeleton "Thing" {\n}\n', "skeletons keep their place"),
    "patches": ('def NurbsPatch "Thing" {\npoint3f[] points = [(0,0,0)]\n}\n', "control points"),
    "sky": ('def DomeLight "Thing" {\n}\n', "lights of this kind"),
    "light textures": ('def RectLight "Thing" {\nasset inputs:texture:file = @a.exr@\n}\n', "inputs:texture:file"),
    "shutter": ('def Camera "Thing" {\ndouble shutter:open = 1\n}\n', "shutter:open not read"),
    "variants": (
        'def Xform "Thing" (prepend variantSets = "look") {\nvariantSet "look" = {\n"a" {\n}\n"b" {\n}\n}\n}\n',
        "only the selected variants",
    ),
    "guides": ('def Xform "Thing" {\nuniform token purpose = "guide"\n}\n', "guide is left out"),
    "render settings": ('def RenderSettings "Thing" {\n}\n', "RenderSettings is left out"),
    "blinking": ('def Xform "Thing" {\ntoken visibility.timeSamples = { 0: "inherited", 1: "invisible" }\n}\n',
                 "visibility that changes"),
    "relationship": (mesh("custom rel friend = </Thing>"), "friend not read"),
    "textures": (TEXTURED + mesh("rel material:binding = </Looks/Paint>",
                                 'prepend apiSchemas = ["MaterialBindingAPI"]'), "textures are not read"),
    "emission": (TEXTURED + mesh("rel material:binding = </Looks/Paint>",
                                 'prepend apiSchemas = ["MaterialBindingAPI"]'), "surface properties beyond"),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_what_is_lost_is_told_with_its_prim(tmp_path: Path, case: str) -> None:
    body, text = CASES[case]
    lines = told(tmp_path, body)
    place = "/Looks/Paint" if "Looks" in body else "/Thing"
    assert any(text in line and place in line for line in lines), lines


def test_one_line_names_all_prims(tmp_path: Path) -> None:
    body = CASES["vertex colours"][0]
    lines = told(tmp_path, body + body.replace("Thing", "Other"))
    assert lines == ["vertex colours are not read: /Thing, /Other"]

"""USD's own shapes become closed surfaces of the right size, along the right axis; curves become edges."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.usd.test_elements import read
from unisg_blender.meshes.triangulate import area_vectors
from unisg_blender.scene.mesh import Mesh

ROUND = np.sin(2 * np.pi / 32) * 32 / (2 * np.pi)
"""Area of a polygon with 32 corners, as a share of its circle's."""


def shape(tmp_path: Path, kind: str, body: str) -> Mesh:
    head = '#usda 1.0\n(\n    metersPerUnit = 1\n    upAxis = "Z"\n)\n'
    graph = read(tmp_path, f'{head}def {kind} "it" {{\n{body}\n}}\n')
    return graph.meshes[graph.mesh[graph.name.index("it")]]


def volume(mesh: Mesh) -> float:
    """Positive where all faces look outwards."""
    a = mesh.points[mesh.triangles[:, 0]].astype(np.float64)
    return float((a * area_vectors(mesh.points, mesh.triangles)).sum() / 6)


def assert_closed(mesh: Mesh) -> None:
    """Every edge belongs to two triangles, once in either direction."""
    ring = mesh.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    edges = {tuple(edge) for edge in ring.tolist()}
    assert len(edges) == len(ring)
    assert edges == {(b, a) for a, b in edges}


SOLIDS = {
    "Cube": ("double size = 3", (1.5, 1.5), (1.5, 1.5), 27.0),
    "Sphere": ("double radius = 2", (2, 2), (2, 2), 4 / 3 * np.pi * 8),
    "Cylinder": ("double radius = 2\ndouble height = 3", (2, 2), (1.5, 1.5), 12 * np.pi),
    "Cone": ("double radius = 2\ndouble height = 3", (2, 2), (1.5, 1.5), 4 * np.pi),
    "Cylinder_1": (
        "double radiusBottom = 2\ndouble radiusTop = 1\ndouble height = 3", (2, 2), (1.5, 1.5), np.pi * (4 + 2 + 1),
    ),
    "Capsule": ("double radius = 2\ndouble height = 3", (2, 2), (3.5, 3.5), 12 * np.pi + 4 / 3 * np.pi * 8),
    "Capsule_1": (
        "double radiusBottom = 2\ndouble radiusTop = 1\ndouble height = 3", (2, 2), (3.5, 2.5),
        np.pi * 7 + 2 / 3 * np.pi * (8 + 1),
    ),
}  # fmt: skip
"""Attributes, half width, how far down and up along the axis, and the volume."""


@pytest.mark.parametrize("axis", ["X", "Y", "Z"])
@pytest.mark.parametrize("kind", SOLIDS)
def test_solids(tmp_path: Path, kind: str, axis: str) -> None:
    body, (wide, _), (down, up), expected = SOLIDS[kind]
    along = "" if kind in ("Cube", "Sphere") else f'uniform token axis = "{axis}"'
    mesh = shape(tmp_path, kind, f"{body}\n{along}")
    assert_closed(mesh)
    assert volume(mesh) == pytest.approx(expected, rel=0.02)
    if kind in ("Cylinder", "Cone", "Cylinder_1"):
        assert volume(mesh) == pytest.approx(expected * ROUND, rel=1e-5)
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    number = "XYZ".index(axis) if along else 2
    np.testing.assert_allclose(low, [-down if k == number else -wide for k in range(3)], atol=1e-5)
    np.testing.assert_allclose(high, [up if k == number else wide for k in range(3)], atol=1e-5)


def test_widths_belong_to_their_ends(tmp_path: Path) -> None:
    mesh = shape(tmp_path, "Cylinder_1", "double radiusBottom = 2\ndouble radiusTop = 1\ndouble height = 3")
    reach = np.hypot(*mesh.points[:, :2].T)
    assert reach[mesh.points[:, 2] < 0].max() == pytest.approx(2)
    assert reach[mesh.points[:, 2] > 0].max() == pytest.approx(1)
    cone = shape(tmp_path, "Cone", "double radius = 2\ndouble height = 3")
    assert np.hypot(*cone.points[cone.points[:, 2] > 0][:, :2].T).max() == 0


@pytest.mark.parametrize(("axis", "normal"), [("X", (1, 0, 0)), ("Y", (0, 1, 0)), ("Z", (0, 0, 1))])
def test_planes(tmp_path: Path, axis: str, normal: tuple[int, ...]) -> None:
    mesh = shape(tmp_path, "Plane", f'double width = 3\ndouble length = 5\nuniform token axis = "{axis}"')
    np.testing.assert_allclose(area_vectors(mesh.points, mesh.triangles).sum(axis=0) / 2, 15.0 * np.array(normal))
    assert mesh.offsets.tolist() == [0, 4]
    size = np.ptp(mesh.points, axis=0)
    wide, long = {"X": (2, 1), "Y": (0, 2), "Z": (0, 1)}[axis]  # as the schema says: X is width unless it is the axis
    np.testing.assert_allclose(sorted(size), [0, 3, 5])
    assert {size[wide], size[long]} == {3, 5}


@pytest.mark.filterwarnings("ignore:curves are read as edges")
def test_curves_are_edges_that_end_where_a_curve_ends(tmp_path: Path) -> None:
    points = "point3f[] points = [(0,0,0), (1,0,0), (2,0,0), (0,5,0), (1,5,0), (9,9,9)]"
    mesh = shape(tmp_path, "BasisCurves", f"int[] curveVertexCounts = [3, 2, 1]\n{points}")
    assert mesh.edges.tolist() == [[0, 1], [1, 2], [3, 4]]
    assert not len(mesh.corners)
    too_many = shape(tmp_path, "BasisCurves", f"int[] curveVertexCounts = [3, 4]\n{points}")
    assert not len(too_many.edges)
    exactly = shape(tmp_path, "BasisCurves", f"int[] curveVertexCounts = [6]\n{points}")
    assert len(exactly.edges) == 5


def test_clouds_are_points_without_faces(tmp_path: Path) -> None:
    mesh = shape(tmp_path, "Points", "point3f[] points = [(0,0,0), (1,0,0)]")
    assert mesh.points.tolist() == [[0, 0, 0], [1, 0, 0]]
    assert not len(mesh.corners)

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from unisg_blender.errors import UniSGError
from unisg_blender.meshes import (
    AtlasNetEncoder,
    decode_cloud,
    decode_mesh,
    decode_oriented_cloud,
    reconstruct,
    sample_surface,
)
from unisg_blender.meshes.decode import patch_normals, signed_volume
from unisg_blender.meshes.sphere import fibonacci_sphere
from unisg_blender.metrics import chamfer_l2
from unisg_blender.scene import Mesh

from .shapes import box, is_closed_and_oriented, joined, sphere


@pytest.mark.parametrize(
    ("mesh", "volume"),
    [(box((1, 2, 0.5)), 1.0), (sphere(), 4.18), (joined(box(), box((1, 1, 1), (3, 0, 0))), 2.0)],
    ids=lambda value: getattr(value, "name", str(value)),
)
def test_surface_through_samples(mesh: Mesh, volume: float) -> None:
    samples = sample_surface(mesh, 3000)
    found = reconstruct(samples.points, samples.normals, 64)
    assert is_closed_and_oriented(found.triangles)
    assert signed_volume(found.points, found.triangles) == pytest.approx(volume, rel=0.02)
    assert np.allclose(found.bounds, mesh.bounds, atol=0.05 * np.ptp(mesh.bounds))


def test_length_of_normals_and_unit_do_not_matter() -> None:
    samples = sample_surface(sphere(), 1500)
    small = reconstruct(samples.points * 0.001 + 5, samples.normals * 7, 32)
    assert signed_volume(small.points - 5, small.triangles) == pytest.approx(4.18e-9, rel=0.03)


@pytest.mark.parametrize(
    ("points", "normals", "message"),
    [
        (np.zeros((3, 3)), np.ones((3, 3)), "4 or more points"),
        (np.eye(4, 3), np.ones((5, 3)), "4 or more points"),
        (np.full((5, 3), np.nan), np.ones((5, 3)), "finite"),
        (np.ones((5, 3)), np.ones((5, 3)), "one place"),
        (np.eye(5, 3), np.zeros((5, 3)), "must not be zero"),
    ],
)
def test_unusable_points(points: np.ndarray, normals: np.ndarray, message: str) -> None:
    with pytest.raises(UniSGError, match=message):
        reconstruct(points, normals)


def test_resolution_out_of_range() -> None:
    with pytest.raises(UniSGError, match="between 16 and 256"):
        reconstruct(np.eye(4, 3), np.ones((4, 3)), 5)


@pytest.mark.slow
@pytest.mark.parametrize("faces", [301, 2000, 60_000])
def test_chosen_number_of_faces(faces: int) -> None:
    samples = sample_surface(box((1, 2, 0.5)), 2000)
    found = reconstruct(samples.points, samples.normals, 48, faces=faces)
    assert len(found.offsets) - 1 == faces + faces % 2
    assert is_closed_and_oriented(found.triangles)
    assert signed_volume(found.points, found.triangles) == pytest.approx(1, rel=0.03)


def test_too_few_faces() -> None:
    with pytest.raises(UniSGError, match="4 faces or more"):
        reconstruct(np.eye(4, 3), np.ones((4, 3)), faces=2)


def test_screening_brings_the_surface_to_the_points(monkeypatch: pytest.MonkeyPatch) -> None:
    samples = sample_surface(box((1, 2, 0.1)), 1500)
    errors = []
    for weight in (0.0, 64.0):
        monkeypatch.setattr("unisg_blender.meshes.poisson.SCREENING", weight)
        found = reconstruct(samples.points, samples.normals, 48)
        errors.append(cKDTree(sample_surface(found, 8000).points).query(samples.points)[0].mean())
    assert errors[1] < 0.7 * errors[0]


def test_a_cloud_with_normals_goes_through_to_a_mesh_that_is_like_the_decoded_one() -> None:
    feature = AtlasNetEncoder().encode([box((1.0, 1.6, 0.8), (4, 5, 6))])[0]
    points, normals = decode_oriented_cloud([feature], 2500)
    assert np.array_equal(points, decode_cloud([feature], 2500))
    assert np.allclose(np.linalg.norm(normals, axis=2), 1)
    found = reconstruct(points[0], normals[0], 64)
    assert is_closed_and_oriented(found.triangles)
    assert signed_volume(found.points, found.triangles) > 0
    unit = feature.placement.scale**2
    direct = sample_surface(decode_mesh(feature), 4000, seed=1).points
    assert chamfer_l2(sample_surface(found, 4000, seed=2).points, direct) < 0.005 * unit


@pytest.mark.parametrize("stretch", [(1.0, 2.0, 3.0), (-1.0, 2.0, 3.0), (0.0, 1.0, 1.0)])
def test_normals_of_a_patch_point_outwards_also_of_a_mirrored_and_of_a_flat_one(stretch: tuple[float, ...]) -> None:
    sphere_points = fibonacci_sphere(2000)
    normals = patch_normals(sphere_points * stretch)
    assert np.isfinite(normals).all()
    assert np.allclose(np.linalg.norm(normals, axis=1), 1)
    if all(stretch):
        exact = sphere_points / stretch
        exact /= np.linalg.norm(exact, axis=1, keepdims=True)
        assert np.einsum("nk,nk->n", normals, exact).min() > 0.97


@pytest.mark.parametrize("count", [4, 7, 60])
def test_small_clouds_keep_their_number_of_points(count: int) -> None:
    feature = AtlasNetEncoder().encode([box()])[0]
    points, normals = decode_oriented_cloud([feature], count)
    assert points.shape == normals.shape == (1, count, 3)
    assert np.isfinite(normals).all()
    with pytest.raises(UniSGError, match="4 points or more"):
        decode_oriented_cloud([feature], 3)

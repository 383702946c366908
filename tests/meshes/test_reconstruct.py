from __future__ import annotations

import numpy as np
import pytest

from unisg_blender.errors import UniSGError
from unisg_blender.meshes import reconstruct, sample_surface
from unisg_blender.meshes.decode import signed_volume
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

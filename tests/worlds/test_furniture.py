from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import trimesh

from unisg_blender.spatial.part_boxes import PART_LIMIT, mesh_parts
from unisg_blender.worlds.furniture.kit import Furniture, ball, block, lathe, prism, rod, turned
from unisg_blender.worlds.furniture.palette import MATERIALS
from unisg_blender.worlds.living_room_world import furnish as furnish_home
from unisg_blender.worlds.operating_room_world import furnish as furnish_theatre

HANGING = {"Surgical Lamp", "IV Bag"}
OWN_ORIGIN = {"Floor", "Wall", "Surgical Lamp"}


def all_assets() -> dict[str, Furniture]:
    found = {}
    for furnish in (furnish_theatre, furnish_home):
        for seed in range(8):
            for obj in furnish(seed).objects:
                found.setdefault(obj.asset.category, obj.asset)
    return found


ASSETS = all_assets()


def volume(part) -> float:
    corners = [part.points[face[0]] for face in part.faces for _ in face[2:]]
    rest = [(part.points[a], part.points[b]) for face in part.faces for a, b in pairwise(face[1:])]
    return sum(float(np.dot(p, np.cross(a, b))) for p, (a, b) in zip(corners, rest, strict=True)) / 6


@pytest.mark.parametrize(
    ("part", "expected"),
    [
        (block("red", (1, 2, 3), (5, 5, 5)), 6.0),
        (prism("red", [(0, 0), (2, 0), (0, 2)], 1, 2), 2.0),
        (rod("red", 0.5, (0, 0, 0), (0, 0, 2), 64), 2 * np.pi * 0.25),
        (rod("red", 0.5, (1, 1, 0), (3, 1, 0), 64), 2 * np.pi * 0.25),
        (lathe("red", [(0, 0), (1, 0), (1, 2), (0, 2)], sides=64), 2 * np.pi),
        (ball("red", (1, 1, 1), (0, 0, 0), 64, 40), 4 / 3 * np.pi),
        (turned(block("red", (1, 2, 3)), 30), 6.0),
    ],
)
def test_shapes_are_closed_and_look_outwards(part, expected):
    assert volume(part) == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("category", sorted(ASSETS))
def test_meshes_are_closed_parts_that_look_outwards(category):
    mesh = ASSETS[category].mesh
    body = trimesh.Trimesh(mesh.points, mesh.triangles, process=False)
    for part in body.split(only_watertight=False):
        assert part.is_watertight
        assert part.volume > 0
    assert set(mesh.materials) <= set(MATERIALS)
    assert mesh.material_index is not None
    assert mesh.material_index.max() < len(mesh.materials)


@pytest.mark.parametrize("category", sorted(ASSETS))
def test_origin_is_the_middle_of_the_bottom(category):
    low, high = ASSETS[category].mesh.bounds
    if category not in OWN_ORIGIN:
        np.testing.assert_allclose((low + high)[:2] / 2, 0, atol=1e-6)
    if category == "Floor":
        assert high[2] == pytest.approx(0, abs=1e-6)
    else:
        assert (high if category in HANGING else low)[2] == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("category", sorted(ASSETS))
def test_surfaces_lie_on_the_asset(category):
    asset = ASSETS[category]
    low, high = asset.mesh.bounds
    for surface in asset.surfaces.values():
        half = np.array([*surface.size, 0]) / 2
        middle = np.array(surface.center)
        assert (middle[:2] - half[:2] >= low[:2] - 0.02).all()
        assert (middle[:2] + half[:2] <= high[:2] + 0.02).all()
        assert low[2] - 0.02 <= middle[2] <= high[2] + 0.02


@pytest.mark.parametrize("category", sorted(ASSETS))
def test_few_parts_and_sizes_as_in_reality(category):
    asset = ASSETS[category]
    assert len(mesh_parts(asset.mesh)) <= PART_LIMIT
    assert len(asset.mesh.offsets) - 1 < 900
    sizes = {
        "Operating Table": (0.52, 2.05, 0.85), "Scalpel": (0.011, 0.16, 0.006), "Mayo Stand": (0.6, 0.5, 1.2),
        "Instrument Table": (1.5, 0.72, 0.9), "Anaesthesia Machine": (0.75, 0.72, 1.4), "Stool": (0.42, 0.42, 0.6),
        "Sofa": (2.0, 0.86, 0.8), "Chair": (0.43, 0.4, 0.9), "Bookshelf": (1.0, 0.3, 1.9), "Tray": (0.46, 0.28, 0.05),
        "Kidney Dish": (0.25, 0.13, 0.045), "Dining Table": (1.5, 0.9, 0.75), "Cabinet": (0.9, 0.5, 1.6),
    }  # fmt: skip
    if category in sizes:
        np.testing.assert_allclose(asset.size, sizes[category], rtol=0.35)

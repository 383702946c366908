from __future__ import annotations

import numpy as np
import pytest

from unisg_blender import errors
from unisg_blender.geometry.polygon import area, inside, outside_distance
from unisg_blender.scene import SceneBuilder, mesh_from_faces
from unisg_blender.spatial.floor_plan import mesh_outline, room_outline

L_SHAPE = np.array([(-2, -2), (2, -2), (2, 0), (0, 0), (0, 2), (-2, 2)], float)


def same_polygon(found, expected):
    assert len(found) == len(expected)
    shifts = [np.roll(found, k, axis=0) for k in range(len(found))]
    assert min(np.abs(shift - expected).max() for shift in shifts) < 1e-5


def slab(outline, thickness=0.1):
    count = len(outline)
    points = np.concatenate([np.column_stack([outline, np.full(count, z)]) for z in (-thickness, 0.0)])
    sides = [[i, (i + 1) % count, count + (i + 1) % count, count + i] for i in range(count)]
    return mesh_from_faces("floor", points, [*sides, list(range(count))[::-1], list(range(count, 2 * count))])


def scene_with(mesh, local=None, category="Floor"):
    builder = SceneBuilder()
    builder.add("floor", uid="floor", mesh=mesh, local=local, category=category)
    return builder


def test_outline_of_a_slab_is_its_upper_face():
    same_polygon(mesh_outline(slab(L_SHAPE)), L_SHAPE)


def test_outline_in_the_world_also_when_turned_and_mirrored():
    matrix = np.array([[0, -1, 0, 3], [1, 0, 0, 1], [0, 0, 1, 0.5], [0, 0, 0, 1.0]])
    found = room_outline(scene_with(slab(L_SHAPE), matrix).build())
    same_polygon(found, L_SHAPE @ matrix[:2, :2].T + (3, 1))
    mirrored = room_outline(scene_with(slab(L_SHAPE), np.diag([-1.0, 1, 1, 1])).build())
    same_polygon(mirrored, (L_SHAPE * (-1, 1))[::-1])
    assert area(mirrored) == pytest.approx(12)


def test_outline_of_a_floor_of_many_tiles():
    x, y = np.meshgrid(np.arange(4.0), np.arange(3.0), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(12)])
    tiles = [[3 * i + j, 3 * i + 3 + j, 3 * i + 4 + j, 3 * i + 1 + j] for i in range(3) for j in range(2)]
    found = mesh_outline(mesh_from_faces("tiles", points, tiles))
    same_polygon(found, np.array([(0, 0), (3, 0), (3, 2), (0, 2)], float))


def test_the_largest_floor_counts():
    builder = scene_with(slab(L_SHAPE * 0.1))
    builder.add("other", uid="other", mesh=slab(L_SHAPE), category="Floor")
    assert area(room_outline(builder.build())) == pytest.approx(12, abs=1e-5)


def test_no_floor_is_said():
    with pytest.raises(errors.UniSGError, match="Floor"):
        room_outline(scene_with(slab(L_SHAPE), category="Table").build())


def test_points_inside_and_how_far_outside():
    points = np.array([(-1, -1), (1, 1), (-1, 1.9), (3, -1), (3, -3), (0.5, 0.25)], float)
    np.testing.assert_array_equal(inside(L_SHAPE, points), [True, False, True, False, False, False])
    np.testing.assert_allclose(outside_distance(L_SHAPE, points), [0, 1, 0, 1, np.sqrt(2), 0.25], atol=1e-12)

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

from unisg_blender.geometry import box_overlap
from unisg_blender.geometry.box_overlap import nearby_pairs, penetration
from unisg_blender.geometry.boxes import Boxes
from unisg_blender.scene import Mesh, SceneBuilder, mesh_from_faces
from unisg_blender.spatial import oriented_boxes
from unisg_blender.spatial.part_boxes import PART_LIMIT, mesh_parts, part_boxes

CUBE = np.stack(np.meshgrid(*[[-0.5, 0.5]] * 3, indexing="ij"), -1).reshape(-1, 3)
CUBE_FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def random_boxes(count: int, seed: int, spread: float, turned: bool = True) -> Boxes:
    rng = np.random.default_rng(seed)
    axes = Rotation.random(count, random_state=seed).as_matrix() if turned else np.tile(np.eye(3), (count, 1, 1))
    return Boxes(
        rng.uniform(-spread, spread, (count, 3)), axes, rng.uniform(0.02, 0.6, (count, 3)), np.ones(count, bool)
    )


def one(boxes: Boxes, k: int) -> Boxes:
    return boxes.take(np.array([k]))


def meets_by_linear_program(boxes: Boxes, i: int, j: int) -> bool:
    """Is there a point in both boxes?"""
    rows, limits = [], []
    for k in (i, j):
        normals = boxes.axes[k].T
        middle = normals @ boxes.center[k]
        rows += [normals, -normals]
        limits += [middle + boxes.half[k], boxes.half[k] - middle]
    found = linprog(np.zeros(3), A_ub=np.concatenate(rows), b_ub=np.concatenate(limits), bounds=(None, None))
    return found.status == 0


def test_penetration_agrees_with_a_linear_program():
    boxes = random_boxes(80, 0, 0.7)
    first, second = np.arange(0, 80, 2), np.arange(1, 80, 2)
    depth = penetration(boxes.take(first), boxes.take(second))
    expected = [meets_by_linear_program(boxes, i, j) for i, j in zip(first, second, strict=True)]
    assert 5 < sum(expected) < 35
    np.testing.assert_array_equal(depth > 0, expected)


def test_pushing_by_the_depth_parts_two_boxes_and_less_does_not():
    boxes = random_boxes(400, 1, 0.4)
    first, second = boxes.take(np.arange(200)), boxes.take(np.arange(200, 400))
    depth = penetration(first, second)
    rng = np.random.default_rng(0)
    ways = rng.normal(size=(200, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    pushed = Boxes(second.center + 0.99 * depth[:, None] * ways, second.axes, second.half, second.solid)
    deep = depth > 0
    assert (penetration(first, pushed)[deep] > 0).all(), "no direction parts them earlier than the depth says"


@pytest.mark.parametrize(
    ("offset", "yaw", "depth"),
    [((0.9, 0, 0), 0, 0.1), ((1.0, 0, 0), 0, 0.0), ((1.5, 0.2, 0), 0, -0.5), ((0, 0, 0), 0.0, 1.0),
     ((1.2, 0, 0), np.pi / 4, 0.5 + np.sqrt(0.5) - 1.2), ((1.3, 0, 0), np.pi / 4, 0.5 + np.sqrt(0.5) - 1.3)],
)  # fmt: skip
def test_known_depths_of_unit_cubes(offset, yaw, depth):
    axes = Rotation.from_rotvec([[0, 0, 0], [0, 0, yaw]]).as_matrix()
    boxes = Boxes(np.array([(0, 0, 0), offset], float), axes, np.full((2, 3), 0.5), np.ones(2, bool))
    np.testing.assert_allclose(penetration(one(boxes, 0), one(boxes, 1)), [depth], atol=1e-12)
    np.testing.assert_allclose(penetration(one(boxes, 1), one(boxes, 0)), [depth], atol=1e-12)


def test_edge_against_edge():
    """Two bars, crossing at a right angle and each standing on an edge: only the product of edges parts them."""
    axes = np.stack([Rotation.from_euler(axis, np.pi / 4).as_matrix() for axis in "xy"])
    half = np.array([[2.0, 0.5, 0.5], [0.5, 2.0, 0.5]])
    for gap in (0.05, -0.05):
        center = np.array([[0, 0, 0], [0, 0, np.sqrt(2) + gap]])
        boxes = Boxes(center, axes, half, np.ones(2, bool))
        np.testing.assert_allclose(penetration(one(boxes, 0), one(boxes, 1)), [-gap], atol=1e-12)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.floats(-3, 3), st.floats(-3, 3))
def test_penetration_does_not_change_under_motions(seed, x, angle):
    boxes = random_boxes(2, seed, 0.6)
    turn = Rotation.from_rotvec([angle, 1, -angle]).as_matrix()
    moved = Boxes(boxes.center @ turn.T + x, turn @ boxes.axes, boxes.half, boxes.solid)
    before = penetration(one(boxes, 0), one(boxes, 1))
    np.testing.assert_allclose(penetration(one(moved, 0), one(moved, 1)), before, atol=1e-9)
    np.testing.assert_allclose(penetration(one(boxes, 1), one(boxes, 0)), before, atol=1e-12)


@pytest.mark.parametrize("swept", [0, 900])
@pytest.mark.parametrize("seed", range(4))
def test_grid_and_sweep_find_exactly_the_pairs_of_brute_force(seed, swept, monkeypatch):
    monkeypatch.setattr(box_overlap, "_SWEEP_UP_TO", swept)
    boxes = random_boxes(900, seed, 6.0)
    sizes = np.random.default_rng(seed).choice([0.02, 1.0, 12.0], (900, 1), p=[0.5, 0.49, 0.01])
    boxes = Boxes(boxes.center, boxes.axes, boxes.half * sizes, boxes.solid)
    reach = np.abs(boxes.axes) @ boxes.half[:, :, None]
    low, high = boxes.center - reach[:, :, 0], boxes.center + reach[:, :, 0]
    meet = ((low[:, None] <= high) & (low <= high[:, None])).all(axis=2)
    expected = np.argwhere(np.triu(meet, 1))
    np.testing.assert_array_equal(nearby_pairs(boxes), expected)
    assert len(expected) > 900


def test_margin_widens_the_search():
    center = np.array([[0, 0, 0], [1.3, 0, 0]], float)
    boxes = Boxes(center, np.tile(np.eye(3), (2, 1, 1)), np.full((2, 3), 0.5), np.ones(2, bool))
    assert len(nearby_pairs(boxes)) == 0
    assert len(nearby_pairs(boxes, margin=0.31)) == 1


def boxes_mesh(centers: np.ndarray, split: bool = False) -> Mesh:
    points, faces = [], []
    for center in centers:
        if split:  # every face with points of its own, as importers make them
            for face in CUBE_FACES:
                faces.append(list(range(len(points), len(points) + 4)))
                points += list(CUBE[face] + center)
        else:
            faces += [[len(points) + corner for corner in face] for face in CUBE_FACES]
            points += list(CUBE + center)
    return mesh_from_faces("boxes", np.array(points), faces)


@pytest.mark.parametrize("split", [False, True])
def test_parts_are_the_connected_shapes(split):
    centers = np.array([[0, 0, 0], [3, 0, 0], [0, 5, 1.0]])
    parts = mesh_parts(boxes_mesh(centers, split))
    order = np.lexsort(parts.mean(axis=1).T[::-1])
    expected = np.stack([centers - 0.5, centers + 0.5], axis=1)[np.lexsort(centers.T[::-1])]
    np.testing.assert_allclose(parts[order], expected, atol=1e-6)


def test_many_parts_are_gathered():
    grid = np.stack(np.meshgrid(*[np.arange(6) * 2.0] * 3, indexing="ij"), -1).reshape(-1, 3)
    mesh = boxes_mesh(grid)
    parts = mesh_parts(mesh)
    assert 8 < len(parts) <= PART_LIMIT
    inside = (mesh.points[:, None] >= parts[:, 0] - 1e-6) & (mesh.points[:, None] <= parts[:, 1] + 1e-6)
    assert inside.all(axis=2).any(axis=1).all()


def test_no_points_no_parts_and_loose_edges_count():
    assert mesh_parts(mesh_from_faces("none", np.zeros((0, 3)), [])).shape == (0, 2, 3)
    wire = Mesh("wire", np.array([[0, 0, 0], [1, 0, 0], [5, 0, 0]], np.float32), np.zeros(0, np.int32),
                np.zeros(1, np.int32), edges=np.array([[0, 1]], np.int32))  # fmt: skip
    assert len(mesh_parts(wire)) == 2


def test_part_boxes_stand_in_the_world():
    mesh = boxes_mesh(np.array([[0, 0, 0], [3.0, 0, 0]]))
    builder = SceneBuilder()
    turn = np.eye(4)
    turn[:3, :3] = Rotation.from_euler("z", 90, degrees=True).as_matrix() * 2.0
    turn[:3, 3] = 1, 2, 3
    root = builder.add("root", uid="root", local=turn)
    builder.add("thing", uid="thing", parent=root, mesh=mesh)
    graph = builder.build()
    found = part_boxes(graph)
    np.testing.assert_array_equal(found.owner, [1, 1])
    np.testing.assert_allclose(np.sort(found.boxes.center[:, 1]), [2, 8], atol=1e-9)
    np.testing.assert_allclose(found.boxes.half, 1.0, atol=1e-6)
    assert len(found.of(1).center) == 2
    assert len(found.of(0).center) == 0
    np.testing.assert_allclose(oriented_boxes(graph).half[1], [4, 1, 1], atol=1e-6)

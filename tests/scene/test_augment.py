from __future__ import annotations

import numpy as np
import pytest

from tests.worlds.digest import digest
from unisg_blender.behaviour import check_scene
from unisg_blender.errors import UniSGError
from unisg_blender.geometry.polygon import area
from unisg_blender.metrics.scene_validity import measure_scene
from unisg_blender.scene import world_matrices
from unisg_blender.scene.augmentation import (
    category_dropout,
    mesh_jitter,
    mirrored,
    pose_noise,
    quarter_turns,
    scale_noise,
)
from unisg_blender.spatial.floor_plan import room_outline
from unisg_blender.worlds import living_room, operating_room

SOURCE = operating_room(0)
CHANGES = {
    "pose_noise": lambda graph, seed: pose_noise(graph, seed),
    "upright": lambda graph, seed: pose_noise(graph, seed, upright=True),
    "scale_noise": lambda graph, seed: scale_noise(graph, seed),
    "mesh_jitter": lambda graph, seed: mesh_jitter(graph, seed),
    "category_dropout": lambda graph, seed: category_dropout(graph, seed, probability=0.3),
    "quarter_turns": lambda graph, seed: quarter_turns(graph, 1 + seed % 3),
    "mirrored": lambda graph, seed: mirrored(graph),
}


@pytest.mark.parametrize("name", CHANGES)
def test_the_source_is_never_changed_and_the_seed_decides(name):
    before = digest(SOURCE)
    first, again = CHANGES[name](SOURCE, 1), CHANGES[name](SOURCE, 1)
    assert digest(SOURCE) == before
    assert digest(first) == digest(again) != before
    if name != "mirrored":
        assert digest(CHANGES[name](SOURCE, 2)) != digest(first)


def free_rows(graph):
    fixed = {"Floor", "Wall", "Ceiling", "Door", "Window", "Ceiling Rail"}
    return np.array([row for row in range(len(graph)) if graph.category_name(row) not in fixed])


def test_pose_noise_has_the_size_asked_for_and_stays_rigid():
    steps, turns = [], []
    for seed in range(12):
        noisy = pose_noise(SOURCE, seed, metres=0.05, radians=0.1)
        rows = free_rows(SOURCE)
        linear = noisy.local[rows, :3, :3]
        np.testing.assert_allclose(
            linear @ np.swapaxes(linear, 1, 2), np.tile(np.eye(3), (len(rows), 1, 1)), atol=1e-12
        )
        change = np.linalg.inv(SOURCE.local[rows]) @ noisy.local[rows]
        steps.append(change[:, :3, 3])
        angle = np.arccos(np.clip((np.trace(change[:, :3, :3], axis1=1, axis2=2) - 1) / 2, -1, 1))
        turns.append(angle)
        fixed = np.setdiff1d(np.arange(len(SOURCE)), rows)
        np.testing.assert_array_equal(noisy.local[fixed], SOURCE.local[fixed])
    assert np.concatenate(steps).std() == pytest.approx(0.05, rel=0.1)
    assert np.sqrt((np.concatenate(turns) ** 2).mean() / 3) == pytest.approx(0.1, rel=0.1)


def test_upright_noise_keeps_things_on_their_supports():
    noisy = pose_noise(SOURCE, 0, metres=0.003, radians=0.01, upright=True)
    np.testing.assert_allclose(noisy.local[:, 2, 3], SOURCE.local[:, 2, 3], atol=1e-12)
    assert measure_scene(noisy).off_support.sum() == 0


def test_scale_noise_multiplies_the_sizes():
    rows, logs = free_rows(SOURCE), []
    for seed in range(8):
        scaled = scale_noise(SOURCE, seed, factor=0.2)
        size = np.linalg.norm(scaled.local[rows, :3, :3], axis=1)
        np.testing.assert_allclose(size, size[:, :1].repeat(3, axis=1), rtol=1e-12)
        logs.append(np.log(size[:, 0]))
        np.testing.assert_array_equal(scaled.local[:, :3, 3], SOURCE.local[:, :3, 3])
    assert np.concatenate(logs).std() == pytest.approx(0.2, rel=0.15)
    stretched = scale_noise(SOURCE, 0, uniform=False)
    assert np.ptp(np.linalg.norm(stretched.local[rows, :3, :3], axis=1), axis=1).max() > 0.05


def test_mesh_jitter_keeps_closed_meshes_closed():
    moved = mesh_jitter(SOURCE, 0, metres=0.01)
    offsets = np.concatenate([b.points - a.points for a, b in zip(SOURCE.meshes, moved.meshes, strict=True)])
    assert offsets.std() == pytest.approx(0.01, rel=0.05)
    for before, after in zip(SOURCE.meshes, moved.meshes, strict=True):
        assert len(np.unique(before.points, axis=0)) == len(np.unique(after.points, axis=0))
        np.testing.assert_array_equal(before.corners, after.corners)


def test_dropout_takes_what_stands_on_things_along():
    for seed in range(6):
        kept = category_dropout(SOURCE, seed, probability=0.4)
        left = {kept.category_name(row) for row in range(len(kept))}
        assert {"Floor", "Wall", "Door"} <= left
        present = set(kept.uid)
        for row in range(len(SOURCE)):
            above = SOURCE.parent[row]
            if SOURCE.uid[row] in present and above >= 0:
                assert SOURCE.uid[above] in present
        np.testing.assert_allclose(
            world_matrices(kept), world_matrices(SOURCE)[[SOURCE.row_of_uid[uid] for uid in kept.uid]], atol=1e-12
        )
    assert len(category_dropout(SOURCE, 0, probability=0.0)) == len(SOURCE)
    with pytest.raises(UniSGError):
        category_dropout(SOURCE, 0, probability=1.5)


@pytest.mark.parametrize("turns", range(-1, 6))
def test_quarter_turns_are_exact(turns):
    graph = quarter_turns(SOURCE, turns)
    report = measure_scene(graph)
    assert not report.faults.any()
    back = quarter_turns(graph, -turns)
    np.testing.assert_array_equal(back.local, SOURCE.local)
    angle = turns * np.pi / 2
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    expected = world_matrices(SOURCE)[:, :2, 3] @ turn.T
    np.testing.assert_allclose(world_matrices(graph)[:, :2, 3], expected, atol=1e-12)


@pytest.mark.parametrize("source", [SOURCE, living_room(1)])
def test_the_mirrored_room_is_a_room(source):
    graph = mirrored(source)
    assert not measure_scene(graph).faults.any()
    assert (np.linalg.det(graph.local[:, :3, :3]) > 0).all()
    assert check_scene(graph) == []
    np.testing.assert_allclose(area(room_outline(graph)), area(room_outline(source)), rtol=1e-6)
    flip = np.diag([-1.0, 1, 1])
    points, mirror = all_points(source), all_points(graph)
    np.testing.assert_allclose(mirror, points @ flip, atol=1e-5)
    for before, after in zip(source.meshes, graph.meshes, strict=True):
        assert signed_volume(after) == pytest.approx(signed_volume(before), rel=1e-4)
    twice = mirrored(graph)
    np.testing.assert_array_equal(twice.local, source.local)
    for before, after in zip(source.meshes, twice.meshes, strict=True):
        np.testing.assert_array_equal(before.points, after.points)
        np.testing.assert_array_equal(before.corners, after.corners)


def all_points(graph):
    world = world_matrices(graph)
    found = [
        graph.meshes[mesh].points @ world[row, :3, :3].T + world[row, :3, 3]
        for row, mesh in enumerate(graph.mesh)
        if mesh >= 0
    ]
    return np.concatenate(found)


def signed_volume(mesh):
    a, b, c = np.moveaxis(mesh.points[mesh.triangles].astype(float), 1, 0)
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6

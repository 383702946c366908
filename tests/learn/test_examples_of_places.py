"""What is learned from rooms: which things, what is left when some are taken away, and how channels are scaled."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.stats import entropy

pytest.importorskip("torch")

from tests.generate.hand_made_room import FLOOR, THINGS, VOCABULARY, observed
from tests.generate.rooms import room
from unisg_blender.generate.observe.contract import Contract
from unisg_blender.generate.observe.observed_scene import relative
from unisg_blender.generate.observe.prior_tables import PriorTables
from unisg_blender.generate.observe.support_priors import CategoryPriors
from unisg_blender.learn.anchors.examples import visible_with
from unisg_blender.learn.cgvae.training import normalisation, predict_mean
from unisg_blender.learn.training_scenes import TrainingScene
from unisg_blender.learn.trees.examples import movable, without_above
from unisg_blender.poses import FORMS
from unisg_blender.scene import world_matrices
from unisg_blender.spatial.objects import scene_objects

TABLES = PriorTables.of(CategoryPriors({}, {}, {}, []), VOCABULARY)


def test_things_with_a_category_and_a_size_are_learned_from() -> None:
    flat = [*THINGS, (5, 0, (1.0, 1.0, 0.0), (0.0, 0.0, 0.0), 0.0), (FLOOR, -1, (9.0, 9, 0), (0.0, 0.0, 0.0), 0.0)]
    assert movable(observed(flat), TABLES).tolist() == [4, 5, 6, 7, 8]


@pytest.mark.parametrize(
    ("gone", "left"),
    [
        ([], range(10)), ([5], [0, 1, 2, 3, 4, 6, 7, 8, 9]), ([4], [0, 1, 2, 3, 7, 8, 9]),
        ([1], [0, 2, 4, 5, 6, 7, 8, 9]), ([0], []), ([9, 8], range(8)),
    ],
)  # fmt: skip
def test_with_a_thing_goes_all_that_is_on_it(gone: list[int], left: list[int]) -> None:
    assert np.flatnonzero(without_above(observed(THINGS), gone)).tolist() == list(left)


def test_channels_that_vary_are_kept_with_their_mean_and_spread() -> None:
    rng = np.random.default_rng(0)
    poses = np.tile(np.eye(4), (60, 1, 1))
    poses[:, :2, 3] = rng.normal((1, -2), (3, 0.1), (60, 2))
    mean, scale, kept = normalisation([poses[:20], poses[20:]], "matrix")
    raw = FORMS["matrix"].encode(poses, stretch=True)
    assert kept.tolist() == [3, 7]
    np.testing.assert_allclose(mean, raw.mean(axis=0))
    np.testing.assert_allclose(scale[kept], poses[:, :2, 3].std(axis=0))
    assert (np.delete(scale, kept) == 1).all()


def test_the_mean_loses_what_spreads_and_the_chance_of_an_edge_its_entropy() -> None:
    graphs = [room(seed) for seed in range(3)]
    found, edges, pairs, features = [], 0, 0, []
    for graph in graphs:
        objects = scene_objects(graph, VOCABULARY)
        world = world_matrices(graph)[objects.row]
        found.append(TrainingScene(objects, world, relative(world, objects.support)))
        edges += int((objects.support >= 0).sum())
        pairs += len(objects) * (len(objects) - 1)
    mean, scale, kept = normalisation([scene.local for scene in found], "quaternion")
    contract = Contract(
        kind="cgvae", vocabulary=tuple(VOCABULARY), priors=CategoryPriors({}, {}, {}, []), form="quaternion",
        mean=tuple(mean.tolist()), scale=tuple(scale.tolist()), kept=tuple(kept.tolist()), latent=4,
    )  # fmt: skip
    for scene in found:
        raw = FORMS["quaternion"].encode(scene.local, stretch=True)
        features.append(((raw - mean) / scale)[:, kept])
    told = predict_mean(found, contract)
    assert told["mse"] == pytest.approx(float((np.concatenate(features) ** 2).mean()), abs=1e-5)
    chance = edges / pairs
    assert told["bce"] == pytest.approx(float(entropy([chance, 1 - chance])), abs=1e-5)


def test_in_order_what_comes_before_is_there() -> None:
    """Of things on one support those of lower rank, then those less far away, then in any order."""
    scene = observed(THINGS)
    count = len(THINGS)
    rank, away, above = np.zeros(count), np.zeros(count), np.zeros((count, count), bool)
    for obj, support in enumerate(scene.support.tolist()):
        while support >= 0:
            above[obj, support] = True
            support = int(scene.support[support])
    rank[[7, 8]], away[[7, 8]] = 2, (0.0, 0.5)
    rank[4] = 1
    layout: Any = SimpleNamespace(
        row=np.arange(count), group=np.array([0, 0, 0, 0, 1, 2, 2, 1, 1, 1]), scene=scene, rank=rank, away=away,
        floor=scene.support == 0, building=np.isin(np.arange(count), (0, 1, 2, 3)), above=above,
    )  # fmt: skip
    seen, orders = [], 0
    for seed in range(300):
        _, placed, in_order = visible_with(layout, 8, np.random.default_rng(seed))
        if in_order:
            orders += 1
            assert placed[7]  # of its own rank and nearer
            assert placed[4]  # of a lower rank
            assert not placed[8]
            assert not placed[[5, 6]].any()  # of a later group
            seen.append(bool(placed[9]))
    assert 100 < orders < 300
    assert all(seen)  # rank 0 comes first
    for seed in range(100):
        _, placed, in_order = visible_with(layout, 4, np.random.default_rng(seed))
        if in_order:
            assert placed[9]
            assert not placed[[7, 8]].any()

"""What is learned from rooms: which things, what is left when some are taken away, and how channels are scaled."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("torch")

from tests.generate.hand_made_room import FLOOR, THINGS, VOCABULARY, observed
from unisg_blender.generate.observe.prior_tables import PriorTables
from unisg_blender.generate.observe.support_priors import CategoryPriors
from unisg_blender.learn.cgvae.training import normalisation
from unisg_blender.learn.trees.examples import movable, without_above
from unisg_blender.poses import FORMS

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

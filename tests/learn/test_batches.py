"""Batches: padded rows, what is made as numbers of rows, and features by the means of what was learned from."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("torch")
pytest.importorskip("torch_geometric")

import torch

from unisg_blender.learn.atlasnet.training import random_rotation, yaw
from unisg_blender.learn.behaviour.examples import collate
from unisg_blender.learn.padding import padded_stack
from unisg_blender.learn.paper.classification import Scenes, standardised


def test_arrays_of_several_sizes_are_filled_up_with_zeros() -> None:
    found = padded_stack([np.ones((1, 3)), np.full((2, 1), 2.0), np.zeros((0, 2))])
    assert found.tolist() == [
        [[1, 1, 1], [0, 0, 0]], [[2, 0, 0], [2, 0, 0]], [[0, 0, 0], [0, 0, 0]],
    ]  # fmt: skip
    assert padded_stack([np.zeros((0, 0), np.int32)]).shape == (1, 1, 1)
    assert padded_stack([np.zeros(1, np.int32), np.ones(1)]).dtype == torch.int32


def item(actions: int, able: list[int], made: list[tuple[int, tuple[int, int, int], int]]) -> dict[str, object]:
    return {"arrays": {"act_mask": np.ones(actions)}, "able": np.array(able), "made": made}


def test_what_follows_an_action_keeps_its_number_and_what_begins_a_stage_moves_behind_the_padding() -> None:
    few = item(2, [0, 2], [(2, (4, -1, 5), 1), (0, (1, 2, 3), 2 + 3)])
    many = item(5, [1], [(1, (0, 0, 0), 4), (1, (0, 0, 1), 5)])
    batch = collate([few, many], 3)
    assert batch["act_mask"].tolist() == [[1, 1, 0, 0, 0], [1, 1, 1, 1, 1]]
    assert batch["wanted"].tolist() == [[1, 0, 1], [0, 1, 0]]
    assert batch["able"].tolist() == [[1, 0, 1], [0, 1, 0]]
    assert batch["made"].tolist() == [
        [0, 2, 4, -1, 5, 1], [0, 0, 1, 2, 3, 5 + 3], [1, 1, 0, 0, 0, 4], [1, 1, 0, 0, 1, 5],
    ]  # fmt: skip
    assert collate([item(1, [], [])], 2)["made"].shape == (0, 6)


def scenes(*features: list[list[float]]) -> list[Scenes]:
    none = torch.zeros(1, dtype=torch.int64)
    return [
        Scenes({"entity": torch.ones(len(x), 1), "trs": torch.tensor(x)}, {}, {}, none, none) for x in features
    ]  # fmt: skip


def test_features_are_scaled_by_what_was_learned_from() -> None:
    like = scenes([[1.0, 5, 0], [3.0, 5, 0]], [[5.0, 5, 2]])
    other = scenes([[9.0, 7, 1], [1e6, 5, 1]])
    (found,) = standardised(other, like)
    mean, spread = 3.0, 2.0
    torch.testing.assert_close(
        found.x["trs"][0], torch.tensor([(9 - mean) / spread, 0.0, (1 - 2 / 3) / np.std([0, 0, 2], ddof=1)]).float()
    )
    assert float(found.x["trs"][1, 0]) == 10  # far out: no farther
    assert found.x["entity"].tolist() == [[1], [1]]
    assert other[0].x["trs"][0, 0] == 9  # what came in is as it was


def test_random_rotations_are_rotations_of_all_kinds() -> None:
    rng = np.random.default_rng(0)
    found = np.stack([random_rotation(rng) for _ in range(2000)])
    np.testing.assert_allclose(found @ found.swapaxes(1, 2), np.tile(np.eye(3), (2000, 1, 1)), atol=1e-9)
    np.testing.assert_allclose(np.linalg.det(found), 1)
    assert np.abs(found.mean(axis=0)).max() < 0.06
    np.testing.assert_allclose(yaw(np.pi / 6) @ [1, 0, 0], [np.sqrt(3) / 2, 0.5, 0])
    np.testing.assert_allclose(yaw(0.3) @ [0, 0, 1], [0, 0, 1])

"""Scenes of a dataset for training, validation and so on."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...errors import UniSGError


def split_rows(
    count: int, fractions: Sequence[float], seed: int, groups: Sequence[str] | None = None
) -> list[NDArray[np.int64]]:
    """Numbers below ``count`` in disjoint lists, at random by ``seed``, each ascending.

    ``fractions`` are shares of the whole; what they leave over belongs to nobody. What is of one of the ``groups``
    (a name for each number) stays together, and shares are met as nearly as that allows.
    """
    if not fractions or min(fractions) < 0 or sum(fractions) > 1 + 1e-9:
        raise UniSGError(f"the shares of a split must be positive and sum to at most 1, not {fractions}")
    order = np.random.default_rng(seed).permutation(count)
    ends = np.rint(np.cumsum([0, *fractions]) * count).astype(int)
    if groups is not None:
        _, first, group, size = np.unique(
            np.asarray(groups), return_index=True, return_inverse=True, return_counts=True
        )  # fmt: skip
        drawn = np.random.default_rng(seed).permutation(len(first))
        order = np.argsort(np.argsort(drawn)[group.reshape(-1)], kind="stable")
        borders = np.cumsum([0, *size[drawn]])
        ends = borders[np.abs(borders[:, None] - ends).argmin(axis=0)]
    return [np.sort(order[a:b]) for a, b in pairwise(ends)]

"""How far boxes of two categories reach into each other in training scenes, though the things themselves do not."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .anchor_batches import Layout

MOST_SCENES = 200
RARE = 0.02
"""Overlaps of pairs that come near each other but overlap in a smaller share of cases are not usual."""

NEAR, SLACK = 0.3, 0.005


def usual_overlaps(layouts: Sequence[Layout], categories: int) -> NDArray[np.float32]:
    """Metres (C + 1, C + 1) to which the box of a thing (row) may reach into that of another (column).

    The footprints of the upright boxes of things that are equally high, neither of which holds
    the other: a stool stands in the box of a desk. A quantile over all pairs that come near.
    """
    width = categories + 1
    keys, depths = [], []
    for layout in layouts[:MOST_SCENES]:
        scene = layout.scene
        low, high = scene.center[:, 2] - scene.half[:, 2], scene.center[:, 2] + scene.half[:, 2]
        level = np.minimum(high[:, None], high) - np.maximum(low[:, None], low)
        depth = _footprint_depth(scene.center, scene.half, scene.yaw)
        apart = ~(layout.above | layout.above.T) & ~np.eye(len(low), dtype=bool)
        one, two = np.nonzero(apart & (level > 0.002) & (depth > -NEAR))
        keys.append((scene.category[one] % width) * width + scene.category[two] % width)
        depths.append(depth[one, two])
    key, depth = np.concatenate(keys), np.concatenate(depths)
    result = np.zeros(width * width, np.float32)
    for number in np.unique(key[depth > 0]):
        limit = float(np.quantile(depth[key == number], 1 - RARE))
        result[number] = limit + SLACK if limit > 0 else 0.0
    return result.reshape(width, width)


def _footprint_depth(
    center: NDArray[np.float64], half: NDArray[np.float64], yaw: NDArray[np.float64]
) -> NDArray[np.float64]:
    """How deep each footprint reaches into each other one (K, K), by separating axes; negative where they are apart."""
    cos, sin = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
    offset = center[None, :, :2] - center[:, None, :2]
    x, y = cos * offset[..., 0] + sin * offset[..., 1], cos * offset[..., 1] - sin * offset[..., 0]
    turn = yaw[None] - yaw[:, None]
    c, s = np.abs(np.cos(turn)), np.abs(np.sin(turn))
    into_x = half[:, None, 0] + c * half[None, :, 0] + s * half[None, :, 1] - np.abs(x)
    into_y = half[:, None, 1] + s * half[None, :, 0] + c * half[None, :, 1] - np.abs(y)
    depth = np.minimum(into_x, into_y)
    return np.minimum(depth, depth.T)

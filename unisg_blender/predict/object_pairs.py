"""Pairs of objects that may touch, and what a network is told about a pair."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..geometry.arrays import Floats, Ints
from ..geometry.boxes import Boxes, world_bounds
from ..geometry.rigid_frames import relative_poses
from ..poses import FORMS

NEAREST = 12
LARGE = 4.0
"""A box that is this many times as long as the median one is compared with all others: floors, walls, tables."""

REACH = 0.25
"""Metres between the axis-aligned boxes of two objects from which on a large one is no candidate."""

FLOOR_SIZE = 1e-3
POSE_FORM = "sixd"
PAIR_CHANNELS = (
    *FORMS[POSE_FORM].channels,
    "up_x", "up_y", "up_z",
    *(f"half_{axis}" for axis in "xyz"), *(f"target_half_{axis}" for axis in "xyz"),
    "log_size", "rise", "top_to_bottom", "middle", "overlap_x", "overlap_y", "rise_metres",
)  # fmt: skip


def candidate_pairs(boxes: Boxes, nearest: int = NEAREST) -> Ints:
    """Ordered pairs (P, 2), subject and target, of objects near each other; sorted, both ways.

    The ``nearest`` by the distance of the middles, and all large ones within reach: O(N log N) in time, O(N) in memory.
    """
    count = len(boxes.center)
    if count < 2:
        return np.zeros((0, 2), np.int64)
    size = boxes.half.max(axis=1)
    large = np.flatnonzero(size > LARGE * np.median(size))
    wanted = min(nearest + 1, count)
    _, near = cKDTree(boxes.center).query(boxes.center, wanted)
    subject = np.repeat(np.arange(count), wanted)
    codes = [subject * count + near.reshape(-1)]
    low, high = world_bounds(boxes)
    for number in large:
        gap = np.maximum(np.maximum(low - high[number], low[number] - high), 0)
        others = np.flatnonzero((gap**2).sum(axis=1) <= REACH**2)
        codes += [others * count + number, number * count + others]
    pairs = np.unique(np.concatenate(codes))
    pairs = np.stack([pairs // count, pairs % count], axis=1)
    return pairs[pairs[:, 0] != pairs[:, 1]]


def box_poses(boxes: Boxes) -> Floats:
    """Rigid poses (N, 4, 4): middle and axes."""
    poses = np.zeros((len(boxes.center), 4, 4))
    poses[:, :3, :3], poses[:, :3, 3], poses[:, 3, 3] = boxes.axes, boxes.center, 1
    return poses


def pair_features(boxes: Boxes, pairs: Ints) -> NDArray[np.float32]:
    """What the shipped network sees of pairs (P, 2): float32 (P, C), :data:`PAIR_CHANNELS`.

    Lengths are in units of the subject's mean half extent, but for the last channel and the
    logarithm of that unit. Moving the scene, or turning it about the vertical, changes nothing but the
    overlaps along the world's x and y.
    """
    subject, target = pairs[:, 0], pairs[:, 1]
    unit = np.maximum(boxes.half[subject].mean(axis=1), FLOOR_SIZE)[:, None]
    relative = relative_poses(box_poses(boxes), pairs)
    relative[:, :3, 3] /= unit
    low, high = world_bounds(boxes)
    rise = low[subject, 2] - high[target, 2]
    common = np.minimum(high[subject], high[target]) - np.maximum(low[subject], low[target])
    channels = [
        FORMS[POSE_FORM].encode(relative),
        boxes.axes[subject, 2],
        boxes.half[subject] / unit,
        boxes.half[target] / unit,
        np.log(unit),
        rise[:, None] / unit,
        (high[subject, 2] - low[target, 2])[:, None] / unit,
        (boxes.center[subject, 2] - boxes.center[target, 2])[:, None] / unit,
        common[:, :2] / unit,
        rise[:, None],
    ]
    return np.concatenate(channels, axis=1).clip(-50, 50).astype(np.float32)


def in_chunks(pairs: Ints, size: int = 200_000) -> Iterator[Ints]:
    """Some pairs at a time, so that memory stays constant."""
    for start in range(0, len(pairs), size):
        yield pairs[start : start + size]

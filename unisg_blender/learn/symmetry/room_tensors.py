"""Rooms as tensors of one batch: any of them side by side, turned about the vertical if that is wanted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from ...geometry.arrays import Ints
from .room_arrays import RoomArrays


@dataclass(frozen=True, eq=False)
class RoomBatch:
    """K rooms of N objects, each of which sees at most NEAREST others.

    ``pose`` (N, 4, 4), metres; ``size`` (N, 6), half extents and their logarithms; ``near`` int64 (N, NEAREST) and
    ``seen`` bool, whether there is such a neighbour. ``rows`` int64 (K, T) and ``there`` bool: the objects of each
    room. ``truth``: what is asked, for pairs, objects or rooms; for places the row of the object that is asked for.
    """

    pose: Tensor
    size: Tensor
    near: Tensor
    seen: Tensor
    rows: Tensor
    there: Tensor
    truth: Tensor


def room_batch(rooms: RoomArrays, task: str, device: torch.device, rng: np.random.Generator | None = None) -> RoomBatch:
    """All of some rooms as tensors on a device, with what a task asks of them; ``rng`` draws which object's place."""
    counts = np.diff(rooms.start)
    place = np.arange(counts.max(initial=1))
    first = np.repeat(rooms.start[:-1], counts)
    there = place < counts[:, None]
    rows = np.where(there, rooms.start[:-1, None] + place, 0)
    truth, seen, near = _truth(rooms, task, rng), rooms.seen, rooms.near + first[:, None]
    if task == "completion":
        seen = seen & ~np.isin(near, truth)  # what is asked for is not there yet
        there = there & ~np.isin(rows, truth)

    def tensor(values: np.ndarray) -> Tensor:
        """Numbers in single precision, others as they are."""
        return torch.as_tensor(values, dtype=torch.float32 if values.dtype.kind == "f" else None, device=device)

    size = np.concatenate([rooms.half, np.log(np.maximum(rooms.half, 1e-3)) + 2], axis=1)
    return RoomBatch(*map(tensor, (rooms.pose, size, near, seen, rows, there, truth)))


def _truth(rooms: RoomArrays, task: str, rng: np.random.Generator | None) -> np.ndarray:
    if task == "completion":
        sizes = np.add.reduceat(rooms.half.sum(axis=1), rooms.start[:-1])  # the same, however the room is turned
        share = np.modf(1e3 * sizes)[0] if rng is None else rng.random(len(rooms))
        return rooms.start[:-1] + (share * np.diff(rooms.start)).astype(np.int64)
    columns = {"supports": rooms.on, "critic": rooms.moved, "behaviour": rooms.acts}
    return columns.get(task, rooms.kind)


def in_parts(count: int, size: int) -> Sequence[Ints]:
    """Numbers below ``count`` in order, about ``size`` at a time."""
    return np.array_split(np.arange(count), max(1, round(count / size)))

"""Questions to a column of parents: how deep each row stands, what hangs below it, where it is in the world."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError

LARGEST = 1e30
"""The largest number in a matrix that can be reckoned with, also in single precision."""


def depths(parent: NDArray[np.integer]) -> NDArray[np.int64]:
    """int64 (N,): steps from each row up to its root, in any row order.

    Raises
    ------
    UniSGError
        If the parents form a cycle or point outside the rows.
    """
    count = len(parent)
    if count and (parent.max() >= count or parent.min() < -1):
        raise UniSGError("a parent is not in the scene: the hierarchy is damaged")
    depth = (parent >= 0).astype(np.int64)
    above = parent.astype(np.int64)
    for _ in range(count.bit_length() + 1):  # pointer doubling: after k rounds `above` is 2^k ancestors up
        inside = above >= 0
        if not inside.any():
            return depth
        depth[inside] += depth[above[inside]]
        above[inside] = above[above[inside]]
    raise UniSGError("the parents form a cycle: an object is its own ancestor")


def compose_world(local: NDArray[np.float64], parent: NDArray[np.integer]) -> NDArray[np.float64]:
    """World matrices (N, 4, 4) from child-to-parent ones, one product per level of the hierarchy."""
    world = np.array(local, np.float64)
    depth = depths(parent)
    if not depth.any():
        return world
    by_level = np.argsort(depth, kind="stable")
    ends = np.searchsorted(depth[by_level], np.arange(1, depth.max(initial=0) + 2))
    for start, stop in pairwise(ends):
        rows = by_level[start:stop]
        world[rows] = world[parent[rows]] @ local[rows]
    return world


def reachable(local: NDArray[np.float64], parent: NDArray[np.integer]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Child-to-parent matrices (N, 4, 4) with which every row stands somewhere, and the rows (K,) where that took one.

    Those had no numbers, or led beyond :data:`LARGEST`; they are the identity now.
    """
    lost = ~(np.abs(local) <= LARGEST).all(axis=(1, 2))
    local = np.where(lost[:, None, None], np.eye(4), local)
    with np.errstate(over="ignore", invalid="ignore"):
        lost |= ~(np.abs(compose_world(local, parent)) <= LARGEST).all(axis=(1, 2))
    return np.where(lost[:, None, None], np.eye(4), local), np.flatnonzero(lost)


def with_rows_below(parent: NDArray[np.integer], chosen: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """bool (N,): the ``chosen`` rows and all rows below them."""
    inside = chosen.copy()
    while (more := (parent >= 0) & inside[parent] & ~inside).any():
        inside |= more
    return inside


def subtree_rows(parent: NDArray[np.integer], row: int) -> NDArray[np.int64]:
    """int64 (K,): a row and all rows below it, ascending."""
    return np.flatnonzero(with_rows_below(parent, np.arange(len(parent)) == row))

"""The canonical entity order: parents before children, siblings sorted naturally by name."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError

_DIGITS = re.compile(r"(\d+)")


def natural_key(name: str) -> tuple[list[str | int], str]:
    """Sort key under which "Cube.2" comes before "Cube.10"; equal but for case falls back to the raw name."""
    parts: list[str | int] = list(_DIGITS.split(name.casefold()))
    parts[1::2] = [int(digits) for digits in parts[1::2]]
    return parts, name


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


def canonical_order(names: Sequence[str], parent: NDArray[np.integer]) -> NDArray[np.int64]:
    """Row numbers in canonical (depth-first) order.

    Every subtree is one run of rows, so the same file always gives the same
    graph and a subtree is a slice. Siblings with one name keep their order.

    Raises
    ------
    UniSGError
        If the parents form a cycle.
    """
    depths(parent)
    children: dict[int, list[int]] = {}
    keys = [natural_key(name) for name in names]
    for row in sorted(range(len(names)), key=keys.__getitem__):
        children.setdefault(int(parent[row]), []).append(row)
    order: list[int] = []
    stack = children.get(-1, [])[::-1]
    while stack:
        row = stack.pop()
        order.append(row)
        stack.extend(children.get(row, ())[::-1])
    return np.array(order, np.int64)

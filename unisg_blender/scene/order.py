"""The canonical entity order: parents before children, siblings sorted naturally by name."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .parents import depths

_DIGITS = re.compile(r"(\d+)")
LONGEST = 18  # digits that surely fit into 64 bits


def natural_key(name: str) -> tuple[list[str | int], str]:
    """Sort key under which "Cube.2" comes before "Cube.10"; equal but for case falls back to the raw name."""
    parts: list[str | int] = list(_DIGITS.split(name.casefold()))
    parts[1::2] = [int(digits) for digits in parts[1::2]]
    return parts, name


def natural_ranks(names: Sequence[str]) -> NDArray[np.int64]:
    """int64 (N,): the place of each name in natural order; equal names keep their order."""
    stems = [name.rstrip("0123456789") for name in names]
    distinct = {stem: stem.casefold() for stem in dict.fromkeys(stems)}
    if any(_DIGITS.search(stem) for stem in distinct) or _tail_length(names, stems) > LONGEST:
        return _inverse(sorted(range(len(names)), key=[natural_key(name) for name in names].__getitem__))
    place = {folded: rank for rank, folded in enumerate(sorted(set(distinct.values())))}
    stem_rank = {stem: place[folded] for stem, folded in distinct.items()}
    rank = np.array([stem_rank[stem] for stem in stems], np.int64)
    tails = [name[len(stem) :] for name, stem in zip(names, stems, strict=True)]
    number = np.array([int(tail) if tail else -1 for tail in tails], np.int64)
    order = np.lexsort((number, rank))
    tied = np.flatnonzero((np.diff(rank[order]) == 0) & (np.diff(number[order]) == 0))
    if any(names[order[at]] != names[order[at + 1]] for at in tied):  # "a1" and "A1", "a1" and "a01"
        order = np.array(sorted(range(len(names)), key=[natural_key(name) for name in names].__getitem__))
    return _inverse(order)


def _tail_length(names: Sequence[str], stems: Sequence[str]) -> int:
    return max((len(name) - len(stem) for name, stem in zip(names, stems, strict=True)), default=0)


def _inverse(order: Sequence[int] | NDArray[np.integer]) -> NDArray[np.int64]:
    places = np.empty(len(order), np.int64)
    places[np.asarray(order, np.int64)] = np.arange(len(order))
    return places


def canonical_order(names: Sequence[str], parent: NDArray[np.integer]) -> NDArray[np.int64]:
    """Row numbers in canonical (depth-first) order.

    Every subtree is one run of rows, so the same file always gives the same
    graph and a subtree is a slice. Siblings with one name keep their order.

    Raises
    ------
    UniSGError
        If the parents form a cycle.
    """
    depth = depths(parent)
    if not len(parent):
        return np.zeros(0, np.int64)
    levels = _runs(np.argsort(depth, kind="stable"), depth)
    size = np.ones(len(parent), np.int64)  # of the subtree
    for rows in reversed(levels[1:]):
        np.add.at(size, parent[rows], size[rows])
    siblings = np.lexsort((natural_ranks(names), parent))
    before = np.cumsum(size[siblings]) - size[siblings]
    first = np.flatnonzero(np.diff(parent[siblings], prepend=-2))  # where each family begins
    before -= np.repeat(before[first], np.diff(first, append=len(siblings)))
    place = np.empty(len(parent), np.int64)
    place[siblings] = before
    for rows in levels[1:]:
        place[rows] += place[parent[rows]] + 1
    return _inverse(place)


def _runs(rows: NDArray[np.int64], depth: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """Rows sorted by depth, cut into levels."""
    return np.split(rows, np.flatnonzero(np.diff(depth[rows])) + 1)

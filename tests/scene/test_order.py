"""The canonical order: parents first, siblings in natural order, subtrees in one run."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from unisg_blender import UniSGError
from unisg_blender.scene.order import canonical_order, natural_key, natural_ranks
from unisg_blender.scene.parents import depths

NAMES = st.lists(
    st.one_of(st.text("aAb12.", max_size=5), st.text("é٣1 ", max_size=4), st.text(max_size=3)), max_size=30
)


@st.composite
def forests(draw):
    """Names, and parents that form no cycle, in any row order."""
    names = draw(NAMES)
    rows = draw(st.permutations(range(len(names))))
    parent = np.full(len(names), -1)
    for place, row in enumerate(rows):
        above = draw(st.integers(-1, place - 1))
        parent[row] = rows[above] if above >= 0 else -1
    return names, parent


@given(NAMES)
def test_ranks_are_those_of_a_sort_by_natural_key(names: list[str]) -> None:
    expected = sorted(range(len(names)), key=lambda row: natural_key(names[row]))
    assert np.argsort(natural_ranks(names)).tolist() == expected


@given(forests())
def test_order_is_depth_first_with_natural_siblings(forest) -> None:
    names, parent = forest

    def walk(row: int) -> list[int]:
        below = sorted(np.flatnonzero(parent == row).tolist(), key=lambda item: natural_key(names[item]))
        return [found for item in below for found in (item, *walk(item))]

    assert canonical_order(names, parent).tolist() == walk(-1)


def test_numbers_sort_as_numbers() -> None:
    names = ["Cube.10", "Cube.9", "Cube", "Cube.100", "cube.9b"]
    assert [names[row] for row in canonical_order(names, np.full(5, -1))] == [
        "Cube", "Cube.9", "cube.9b", "Cube.10", "Cube.100",
    ]  # fmt: skip


def test_a_deep_chain() -> None:
    parent = np.arange(-1, 4999)
    assert canonical_order(["x"] * 5000, parent).tolist() == list(range(5000))
    assert depths(parent).tolist() == list(range(5000))


@pytest.mark.parametrize("parent", [[1, 0], [0], [2, 0, 1], [-1, 5], [-2, -1]])
def test_damaged_parents_are_refused(parent: list[int]) -> None:
    with pytest.raises(UniSGError):
        canonical_order(["x"] * len(parent), np.array(parent))

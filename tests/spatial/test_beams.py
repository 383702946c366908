"""Beams over open floor part no rooms, lintels over doors do; a beam may be told from several pieces of one line."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from unisg_blender.spatial.structure.beams import is_beam


def line(start: float, stop: float, y: float = 0.0) -> list[list[float]]:
    return [[start, y], [stop, y]]


def turned(segments: list[list[list[float]]], degrees: float) -> np.ndarray:
    angle = np.radians(degrees)
    matrix = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return np.array(segments, float).reshape(-1, 2, 2) @ matrix.T + (3.0, -7.0)


FAR = line(0, 8, 5.0)

CASES = {
    "over open floor": ([line(0, 4)], [FAR], [True]),
    "over a wall": ([line(0, 4)], [line(0, 4)], [False]),
    "a lintel between two walls": ([line(0, 3), line(3, 4), line(4, 8)], [line(0, 3), line(4, 8)], [False] * 3),
    "a wall under a little of it": ([line(0, 8)], [line(0, 1)], [True]),
    "a wall under more of it": ([line(0, 8)], [line(0, 1.3)], [False]),
    "walls that overlap count once": ([line(0, 8)], [line(0, 0.9), line(0.1, 1.0), line(0.2, 0.8)], [True]),
    "walls under both ends": ([line(0, 8)], [line(0, 0.7), line(7.3, 8)], [False]),
    "walls beyond it": ([line(0, 4)], [line(-9, -1), line(5, 9)], [True]),
    "a wall beside it": ([line(0, 4)], [line(0, 4, 0.5)], [True]),
    "a wall nearly in line": ([line(0, 4)], [line(0, 4, 0.2)], [False]),
    "a wall across": ([line(0, 4)], [[[2, -3], [2, 3]]], [True]),
    "too short": ([line(0, 0.9)], [FAR], [False]),
    "short pieces make a long one": ([line(0, 0.6), line(0.8, 1.4)], [FAR], [True, True]),
    "pieces far apart": ([line(0, 0.9), line(1.3, 2.2)], [FAR], [False, False]),
    "one of two lines": ([line(0, 4), line(0, 4, 2.0)], [line(0, 4, 2.0)], [True, False]),
    "the run with a wall, and the one without": ([line(0, 3), line(4, 8)], [line(4, 8)], [True, False]),
}


@pytest.mark.parametrize("degrees", [0.0, 37.0, 90.0, 152.0, 180.0, 271.0])
@pytest.mark.parametrize("name", CASES)
def test_what_is_a_beam(name: str, degrees: float) -> None:
    over, walls, expected = CASES[name]
    assert is_beam(turned(over, degrees), turned(walls, degrees)).tolist() == expected


@given(st.integers(0, 10**6))
def test_ends_and_order_of_segments_say_nothing(seed: int) -> None:
    rng = np.random.default_rng(seed)
    over = turned([line(0, 0.6), line(0.8, 1.4), line(5, 8), line(0, 4, 2.0)], 20.0)
    walls = turned([FAR, line(5, 8), line(0, 1, 2.0)], 20.0)
    order = rng.permutation(len(over))
    swapped = np.where(rng.random(len(over))[:, None, None] < 0.5, over[:, ::-1], over)
    assert (
        is_beam(swapped[order], walls[rng.permutation(3)]).tolist()
        == np.array([True, True, False, False])[order].tolist()
    )


def test_without_walls_or_segments_there_is_none() -> None:
    assert not is_beam(np.zeros((0, 2, 2)), turned([FAR], 0)).size
    assert is_beam(turned([line(0, 4)], 0), np.zeros((0, 2, 2))).tolist() == [False]

"""A floor on which one thing after another is put, beside one whose parts are looked for anew each time."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import label

from unisg_blender.geometry.planar import outside_rectangle
from unisg_blender.spatial.free_floor import PLACE, FreeFloor

OUTLINE = np.array([[0, 0], [5, 0], [5, 2.2], [2.4, 2.2], [2.4, 4], [0, 4.0]])


def sizes(free: np.ndarray) -> list[int]:
    return sorted(np.bincount(label(free, np.ones((3, 3)))[0].ravel())[1:].tolist())


@pytest.mark.parametrize("seed", range(12))
def test_parts_stay_what_they_are_however_things_cover_them(seed):
    rng, floor = np.random.default_rng(seed), FreeFloor.of(OUTLINE)
    free, apart = floor.parts > 0, False
    for _ in range(40):
        center, half, yaw = rng.uniform([-0.5, -0.5], [5.5, 4.5]), rng.uniform(0.02, 0.9, 2), rng.uniform(0, 3)
        floor = floor.without(center, half, yaw)
        free = free & (outside_rectangle(floor.middles - center, yaw, half) > floor.width / 2)
        np.testing.assert_array_equal(floor.parts > 0, free)
        found = sizes(free)
        assert sorted(size for size in floor.sizes.tolist() if size) == found
        assert floor.places == sum(size * floor.grid.cell**2 >= PLACE for size in found)
        assert floor.reachable == (max(found) / sum(found) if found else 1.0)
        for part in range(1, len(floor.sizes) + 1):
            assert label(floor.parts == part, np.ones((3, 3)))[1] == bool(floor.sizes[part - 1])
        apart |= len(found) > 1
    assert apart, "nothing fell apart: the test shows nothing"


def test_a_thing_beside_the_floor_changes_nothing():
    floor = FreeFloor.of(OUTLINE)
    assert floor.without(np.array([4.0, 3.5]), np.array([0.2, 0.2]), 0.3) is floor


def test_a_floor_that_is_covered_has_no_parts():
    floor = FreeFloor.of(OUTLINE).without(np.array([2.5, 2.0]), np.array([9.0, 9.0]), 0.0)
    assert (floor.places, floor.reachable) == (0, 1.0)

from __future__ import annotations

import numpy as np
import pytest

from unisg_blender.metrics.layout_distances import (
    LayoutSet,
    layout_of,
    mean_pairwise,
    nearest_room_distances,
    novelty_limit,
)

from .hand_made import Scene


def layout(*rows):
    return np.array(rows, np.float32)


def test_distance_is_the_mean_way_to_the_nearest_of_the_same_kind():
    rooms = LayoutSet([layout((0, 0, 0), (0, 2, 0), (1, 1, 1))], 2)
    moved = layout((0, 0.3, 0), (0, 2, 0.1), (1, 1, 1))
    np.testing.assert_allclose(rooms.distances(moved), [(0.3 + 0.1 + 0) / 3], atol=1e-6)


def test_distances_are_cut_off_at_a_metre_also_for_what_is_missing():
    rooms = LayoutSet([layout((0, 0, 0))], 2)
    np.testing.assert_allclose(rooms.distances(layout((0, 3, 4), (1, 0, 0))), [1.0])


@pytest.mark.parametrize("turn", [0, 1, 2, 3])
def test_a_room_turned_by_quarters_is_the_same_room(turn):
    points = np.array([[0.5, 2.0], [-1.0, 0.3], [2.0, -1.5]])
    cos, sin = (1, 0, -1, 0)[turn], (0, 1, 0, -1)[turn]
    turned = points @ np.array([[cos, sin], [-sin, cos]])
    first, second = (np.column_stack([[0, 0, 1], p]).astype(np.float32) for p in (points, turned))
    assert LayoutSet([first], 2).distances(second) == pytest.approx(0, abs=1e-6)


def test_copies_are_not_new_and_real_rooms_are_by_definition():
    rng = np.random.default_rng(0)
    layouts = [np.column_stack([np.arange(6) % 3, rng.uniform(-3, 3, (6, 2))]).astype(np.float32) for _ in range(60)]
    training, real = layouts[:30], layouts[30:]
    rooms = LayoutSet(training, 3)
    limit = novelty_limit(nearest_room_distances(real, rooms))
    assert (nearest_room_distances(training, rooms) > limit).mean() == 0
    assert (nearest_room_distances(real, rooms) > limit).mean() == pytest.approx(0.95, abs=0.04)


def test_rooms_that_are_all_alike_have_no_diversity():
    same = [layout((0, 0, 0), (1, 1, 0))] * 4
    assert mean_pairwise(same, 2) == pytest.approx(0, abs=1e-6)
    shifted = [layout((0, 0.1 * k, 0)) for k in range(3)]
    assert mean_pairwise(shifted, 1) == pytest.approx((0.1 + 0.2 + 0.1) / 3, abs=1e-6)


def test_layouts_are_seen_from_the_middle_of_the_room():
    scene = Scene()
    scene.box("a", (0.5, 0.5, 0.5), (1, 0.5, 0), category="Box")
    scene.box("b", (0.5, 0.5, 0.5), (-1, 0, 0), category="Unheard")
    np.testing.assert_allclose(layout_of(scene.build(), ("Box", "Cup")), [[0, 1, 0.5]])

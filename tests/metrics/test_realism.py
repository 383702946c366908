from __future__ import annotations

import numpy as np
import pytest

from unisg_blender.metrics.layout_features import (
    ANGLE,
    FAR,
    LENGTH,
    OBJECT,
    PAIR,
    PLAIN,
    SAMPLED,
    scene_features,
    scene_kinds,
    scene_width,
)
from unisg_blender.metrics.two_sample_test import c2st, noisy

from .hand_made import Scene

VOCABULARY = ("Box", "Cup", "Table")
TREES = 30


def room(rng, shift=0.0):
    """A table near the middle of the room, a box 0.8 m in front of it and ``shift`` aside, a cup on the table."""
    scene = Scene()
    x, y = rng.normal(0, 0.2, 2)
    table = scene.box("table", (1.2, 0.8, 0.7), (x, y, 0), category="Table")
    scene.box("cup", (0.1, 0.1, 0.1), (*rng.normal(0, 0.1, 2), 0.7), category="Cup", parent=table)
    scene.box("box", (0.3, 0.3, 0.3), (x + shift + rng.normal(0, 0.05), y - 0.8, 0), category="Box")
    return scene.build()


def features_by_name():
    scene = Scene()
    table = scene.box("table", (1.2, 0.8, 0.7), (1, 0.5, 0, np.pi / 2), category="Table")
    scene.box("cup", (0.1, 0.2, 0.1), (0.3, 0.1, 0.7, np.pi / 6), category="Cup", parent=table)
    scene.box("other cup", (0.1, 0.2, 0.1), (-0.3, 0.1, 0.7), category="Cup", parent=table)
    found = scene_features(scene.build(), VOCABULARY, np.random.default_rng(0))
    rows = [dict(zip(OBJECT, row, strict=True)) for row in found.objects]
    cup = next(row for row in rows if row["category"] == 1 and row["turn on support"] > 0.1)
    table = next(row for row in rows if row["category"] == 2)
    return found, table, cup


def test_the_features_of_an_object_are_what_they_say():
    _, table, cup = features_by_name()
    assert (cup["support category"], cup["things on the support"], table["things on the support"]) == (2, 2, 1)
    np.testing.assert_allclose([cup["x on support"], cup["y on support"]], [0.3, 0.1], atol=1e-6)
    np.testing.assert_allclose([cup["bottom over support"], cup["turn on support"]], [0.7, np.pi / 6], atol=1e-6)
    np.testing.assert_allclose(cup["distance to neighbour"], 0.6, atol=1e-6)
    np.testing.assert_allclose(cup["distance to its like"], 0.6, atol=1e-6)
    np.testing.assert_allclose([cup["x of its like"], cup["y of its like"]], [-0.6 * np.cos(np.pi / 6), 0.3], atol=1e-6)
    np.testing.assert_allclose(cup["turn of its like"], -np.pi / 6, atol=1e-6)
    np.testing.assert_allclose(table["distance to wall"], 1.5, atol=1e-6)
    assert table["distance to neighbour"] == table["distance to its like"] == FAR


def test_pairs_are_of_things_on_one_support():
    found, _, _ = features_by_name()
    names = list(PAIR)
    assert found.pairs.shape == (2, len(PAIR))
    assert (found.pairs[:, names.index("support category")] == 2).all()
    np.testing.assert_allclose(found.pairs[:, names.index("distance")], 0.6, atol=1e-6)


def test_few_objects_are_drawn_of_a_large_scene_and_an_empty_one_has_none():
    scene = Scene()
    for number in range(3 * SAMPLED):
        scene.box(f"box {number}", (0.1, 0.1, 0.1), (0.15 * number - 1.5, 0, 0))
    found = scene_features(scene.build(), VOCABULARY, np.random.default_rng(0))
    assert len(found.objects) == len(found.pairs) == SAMPLED
    assert found.scene.shape == scene_kinds(VOCABULARY).shape == (scene_width(VOCABULARY),)
    empty = scene_features(Scene().build(), VOCABULARY, np.random.default_rng(0))
    assert len(empty.objects) == len(empty.pairs) == 0


def test_moving_and_turning_the_room_changes_no_feature():
    from .hand_made import at

    graph = room(np.random.default_rng(1))
    local = graph.local.copy()
    local[0] = at(3, -2, 0, 0.7) @ local[0]
    one, two = (scene_features(g, VOCABULARY, np.random.default_rng(5)) for g in (graph, graph.replace(local=local)))
    for first, second, kinds in ((one.objects, two.objects, OBJECT), (one.pairs, two.pairs, PAIR)):
        turn = np.array(list(kinds.values())) == ANGLE  # -180 and 180 degrees are one
        np.testing.assert_allclose(first[:, ~turn], second[:, ~turn], atol=1e-6)
        np.testing.assert_allclose(np.cos(first[:, turn] - second[:, turn]), 1, atol=1e-9)
    np.testing.assert_allclose(one.scene, two.scene, atol=1e-5)


def test_noise_is_on_lengths_and_angles_only():
    kinds = np.array([PLAIN, LENGTH, ANGLE])
    values = np.tile([2.0, 1.0, 0.5], (4000, 1))
    found = noisy(values, kinds, 0.03, np.random.default_rng(0))
    assert (found[:, 0] == 2).all()
    assert found[:, 1].std() == pytest.approx(0.03, rel=0.05)
    turns = np.arctan2(found[:, 3], found[:, 2])
    assert turns.std() == pytest.approx(0.06, rel=0.05)
    np.testing.assert_allclose([found[:, 1].mean(), turns.mean()], [1.0, 0.5], atol=0.005)


def rooms(seeds, shift=0.0):
    return [scene_features(room(np.random.default_rng(s), shift), VOCABULARY, np.random.default_rng(s)) for s in seeds]


@pytest.mark.slow
@pytest.mark.parametrize("level", ["objects", "pairs", "scene"])
def test_rooms_of_one_kind_cannot_be_told_apart_and_others_can(level):
    real = rooms(range(40))
    alike = c2st(real, rooms(range(100, 140)), level, 0.01, VOCABULARY, trees=TREES)
    other = c2st(real, rooms(range(100, 140), shift=0.6), level, 0.01, VOCABULARY, trees=TREES)
    assert alike.shape == (80,)
    assert 0.3 < np.nanmean(alike) < 0.68
    assert np.nanmean(other) > (0.9 if level == "scene" else 0.6)


@pytest.mark.slow
def test_more_noise_hides_more_and_the_same_seed_gives_the_same():
    real, made = rooms(range(40)), rooms(range(100, 140), shift=0.15)
    sharp, blurred, again = (c2st(real, made, "scene", noise, VOCABULARY, trees=TREES) for noise in (0.01, 1.0, 0.01))
    assert np.mean(sharp) > np.mean(blurred) + 0.15
    np.testing.assert_array_equal(sharp, again)

"""Scores of places: the true one has no error, others the one by which they are moved, turned, lifted, sunk."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

pytest.importorskip("onnxruntime")

from unisg_blender.experiments.rooms.place_scores import (
    GROUPS,
    REMOVED,
    SCORES,
    PlaceJudge,
    Removed,
    layouts_of,
    removals,
)
from unisg_blender.generate import Generator
from unisg_blender.pretrained import find_generator
from unisg_blender.scene.categories import STRUCTURE
from unisg_blender.worlds import living_room

SEEDS = range(3)


@cache
def generator() -> Generator:
    return Generator.load(find_generator("living_room"))


@cache
def taken() -> tuple[Removed, ...]:
    known = generator().contract.vocabulary
    return tuple(item for seed in SEEDS for item in removals(living_room(seed), known, 1, seed))


@cache
def judge(room: int) -> PlaceJudge:
    return PlaceJudge(generator(), next(item.rest for item in taken() if item.room == room))


def score(item: Removed, *places: np.ndarray, support: int | None = None) -> dict[str, float]:
    own = judge(item.room)
    there = holder(item) if support is None else support
    return dict(zip(SCORES, own.scores(item, np.array(places), [there] * len(places)), strict=True))


def holder(item: Removed) -> int:
    own = judge(item.room)
    alike = [obj for obj in range(len(own.scene.labels)) if own._kind(obj) == item.holder]
    far = [np.linalg.norm(own.scene.observed.center[obj] - item.place[:3]) for obj in alike]
    return alike[int(np.argmin(far))] if alike else -1


def test_five_things_of_each_room_are_taken_with_all_that_is_on_them() -> None:
    for seed in SEEDS:
        graph = living_room(seed)
        mine = [item for item in taken() if item.room == seed]
        assert 1 <= len(mine) <= REMOVED
        for item in mine:
            assert item.category not in STRUCTURE
            assert item.group in GROUPS
            assert item.rest is mine[0].rest
            left = [item.rest.category_name(row) for row in range(len(item.rest))]
            all_of_it = [graph.category_name(row) for row in range(len(graph))]
            assert left.count(item.category) < all_of_it.count(item.category)
            on_thing = item.holder not in ("", *STRUCTURE)
            assert (item.group == "on things") == on_thing
    assert {item.group for item in taken()} >= {"floor", "on things"}
    again = removals(living_room(0), generator().contract.vocabulary, 1, 0)
    assert [item.category for item in again] == [item.category for item in taken() if item.room == 0]
    other = removals(living_room(0), generator().contract.vocabulary, 2, 0)
    assert [tuple(item.place) for item in other] != [tuple(item.place) for item in again]


def test_the_true_place_has_no_error() -> None:
    for item in taken():
        found = dict(zip(SCORES, judge(item.room).truth(item), strict=True))
        assert np.isnan(found["energy"])
        assert np.isnan(found["degrees"])
        assert (found["metres"], found["height"], found["same_kind"]) == (0, 0, 1)
        assert found["collide"] == found["float"] == 0, item.category
        assert np.isnan(found["facing"]) if item.group == "on things" else found["facing"] == 1


def test_what_is_moved_is_off_by_that() -> None:
    for item in taken():
        aside, lifted = item.place + np.array([0.3, 0.4, 0, 0]), item.place + np.array([0, 0, 0.2, 0])
        assert score(item, aside)["metres"] == pytest.approx(0.5)
        assert score(item, aside)["height"] == 0
        found = score(item, aside, lifted)
        assert (found["metres"], found["height"]) == (pytest.approx(0.35), pytest.approx(0.1))
        assert found["energy"] > 0


@pytest.mark.parametrize(("degrees", "facing"), [(40, 1), (-44, 1), (46, 0), (180, 0), (-91, 0)])
def test_what_is_turned_from_its_wall_faces_another_way(degrees: float, facing: float) -> None:
    for item in taken():
        if item.group != "floor":
            continue
        own = judge(item.room)
        turned = item.place + np.array([0, 0, 0, np.radians(degrees)])
        gaps = [own.walls.gaps(place[None], item.placeable.half)[0][0] for place in (item.place, turned)]
        if gaps[0].argmin() == gaps[1].argmin():  # its size turns with it: another wall may be nearer then
            assert score(item, turned)["facing"] == facing
        half = score(item, item.place, turned)["facing"]
        assert half >= 0.5


def test_what_hangs_in_the_air_floats_and_what_is_within_others_collides() -> None:
    for item in taken():
        assert score(item, item.place + np.array([0, 0, 40.0, 0]))["float"] == 1
        assert score(item, item.place + np.array([0, 0, 40.0, 0]))["collide"] == 0
        own = judge(item.room)
        space = own.scene.space
        solid = [k for k, obj in enumerate(space.owner) if own._kind(obj) not in ("", *STRUCTURE, item.holder)]
        part = max(solid, key=lambda k: space.boxes.half[k].min())
        obstacle, middle = int(space.owner[part]), space.boxes.center[part]
        within = np.array([*middle[:2], middle[2] - item.placeable.half[2], 0.0])
        assert score(item, within, support=-1)["collide"] == 1
        assert score(item, within, support=obstacle)["float"] == 0
        assert score(item, item.place, support=-1)["same_kind"] == (item.holder == "")


def test_places_are_drawn_on_supports_by_the_generator() -> None:
    item = taken()[0]
    places, supports = judge(item.room).draws(item, np.random.default_rng(0), 4)
    assert places.shape == (4, 4)
    assert len(supports) == 4
    again, _ = judge(item.room).draws(item, np.random.default_rng(0), 4)
    np.testing.assert_array_equal(places, again)


def test_layouts_are_what_proposers_learn_from() -> None:
    vocabulary = generator().contract.vocabulary
    (one,) = layouts_of([living_room(0)], vocabulary)
    assert len(one.category) == len(one.world)
    assert (one.category >= 0).sum() > 10

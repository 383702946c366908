"""Places by rule: on tops, along walls with the front into the room, where nothing is in the way."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.generate.hand_made_room import CHAIR, CUP, DOOR, TABLE, THINGS, observed
from unisg_blender.generate.propose.proposer import Query
from unisg_blender.generate.propose.rule_proposer import BEFORE, CLEAR_OF_DOORS, TO_WALL, RuleProposer, _at_walls

PLACES = {TABLE: "wall", CUP: "top", CHAIR: "floor"}


def query(category: int, half: tuple[float, ...], *allowed: int) -> Query:
    scene = observed(THINGS)
    shape: Any = SimpleNamespace(half=np.array(half))
    return Query(scene, category, shape, np.isin(np.arange(len(scene.yaw)), allowed), {})


def corners(center: np.ndarray, half: np.ndarray, yaw: float) -> np.ndarray:
    along, across = np.array([np.cos(yaw), np.sin(yaw)]), np.array([-np.sin(yaw), np.cos(yaw)])
    return np.array([center[:2] + i * half[0] * along + j * half[1] * across for i in (-1, 1) for j in (-1, 1)])


def bounds(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return points.min(axis=0), points.max(axis=0)


def meet(first: np.ndarray, second: np.ndarray, clearance: float = 0.0) -> bool:
    """Do the boxes around two sets of corners overlap, or come nearer than a clearance?"""
    (a, b), (c, d) = bounds(first), bounds(second)
    return bool(((a - d < clearance) & (c - b < clearance)).all())


@pytest.mark.parametrize("yaw", [0.0, 0.5, np.pi / 2, 2.8, -1.9])
def test_what_stands_before_a_place_and_doors_count(yaw: float) -> None:
    half = np.array([0.4, 0.2, 0.5])
    asked, rng = query(CHAIR, (0.4, 0.2, 0.5), 0), np.random.default_rng(0)
    places = np.column_stack([rng.uniform(-2.5, 3, 200), rng.uniform(-2.4, 2.2, 200), np.zeros(200), np.full(200, yaw)])
    found = RuleProposer(PLACES, DOOR)._crowded(asked.scene, half, places)
    without = RuleProposer(PLACES)._crowded(asked.scene, half, places)
    scene = asked.scene
    things = [k for k in range(len(scene.yaw)) if scene.support[k] >= 0 and scene.half[k, 2] > 0.1 and k not in (1, 2)]
    for place, crowded, no_door in zip(places, found, without, strict=True):
        ahead = np.array([np.sin(place[3]), -np.cos(place[3])])  # fronts look along -y
        zone = corners(place[:2] + ahead * (half[1] + BEFORE / 2), np.array([half[0], BEFORE / 2]), place[3])
        theirs = {k: corners(scene.center[k], scene.half[k], scene.yaw[k]) for k in things}
        assert no_door == sum(meet(zone, theirs[k]) for k in things)
        blocked = meet(corners(place, half, place[3]), theirs[3], CLEAR_OF_DOORS)
        assert crowded == no_door + 10 * blocked
    assert len(np.unique(found)) > 3


def test_along_walls_backs_are_to_them() -> None:
    scene, walls = observed(THINGS), np.array([1, 2])
    places = _at_walls(scene, 0, walls, np.array([0.6, 0.3, 0.4]), 400, np.random.default_rng(0))
    np.testing.assert_allclose(places[:, 2], 0)
    fronts = np.stack([np.sin(places[:, 3]), -np.cos(places[:, 3])], axis=1)
    north = np.isclose(places[:, 1], 2.2 - 0.3 - TO_WALL)
    west = np.isclose(places[:, 0], -2.8 + 0.3 + TO_WALL)
    assert (north ^ west | north & west).all()
    np.testing.assert_allclose(fronts[north & ~west], np.tile([0, -1], (int((north & ~west).sum()), 1)), atol=1e-9)
    np.testing.assert_allclose(fronts[west & ~north], np.tile([1, 0], (int((west & ~north).sum()), 1)), atol=1e-9)
    assert north.mean() == pytest.approx(3.1 / (3.1 + 2.4), abs=0.08)


def test_the_freest_places_come_first() -> None:
    asked = query(TABLE, (0.6, 0.3, 0.4), 0)
    proposer = RuleProposer(PLACES, DOOR)
    for seed in range(10):
        proposals = proposer.propose(asked, 6, np.random.default_rng(seed))
        assert proposals.support.tolist() == [0] * 6
        crowded = proposer._crowded(asked.scene, asked.placeable.half, proposals.places)
        assert (np.diff(crowded) >= 0).all()
        assert crowded[0] == 0


def test_on_floors_things_are_within_and_along_the_walls_directions() -> None:
    places = RuleProposer(PLACES).propose(query(CHAIR, (0.25, 0.3, 0.45), 0, 4), 40, np.random.default_rng(1)).places
    assert (np.abs(places[:, 0] - 0.3) <= 3.1 - 0.3 + 1e-9).all()
    assert (np.abs(places[:, 1] + 0.2) <= 2.4 - 0.3 + 1e-9).all()
    np.testing.assert_allclose(np.abs(np.cos(2 * places[:, 3])), 1)
    assert np.ptp(places[:, 0]) > 2


def test_on_tops_things_stand_where_there_is_one_and_nowhere_without() -> None:
    proposals = RuleProposer(PLACES).propose(query(CUP, (0.05, 0.04, 0.06), 4), 30, np.random.default_rng(2))
    assert set(proposals.support) == {4}
    offset = proposals.places[:, :2] - np.array([-0.6, 0.4])
    cos, sin = np.cos(0.4), np.sin(0.4)
    local = offset @ np.array([[cos, -sin], [sin, cos]])
    assert (np.abs(local) <= [0.7, 0.4]).all()
    nobody = RuleProposer(PLACES).propose(query(CUP, (0.05, 0.04, 0.06)), 5, np.random.default_rng(2))
    assert nobody.support.tolist() == [-1] * 5

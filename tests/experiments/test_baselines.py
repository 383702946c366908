"""The simple ways to place objects: what they learned is where things stood, and their densities are densities."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import norm

from tests.generate.hand_made_room import CHAIR, CUP, FLOOR, TABLE, THINGS, VOCABULARY, WALL, observed
from unisg_blender.experiments.rooms.baselines import (
    SPREAD_FLOOR,
    CopyProposer,
    GaussianProposer,
    WorldGaussianProposer,
    carrier_of,
    nearest_room,
    offsets,
    signature,
)
from unisg_blender.generate.observe.observed_scene import ObservedScene
from unisg_blender.generate.propose.proposer import Query
from unisg_blender.worlds import living_room

CHAIRS, CUPS = (7, 8), (5, 6)


def moved(things: list, dx: float, dy: float, turn: float) -> ObservedScene:  # type: ignore[type-arg]
    """The room elsewhere, turned about the vertical."""
    cos, sin = np.cos(turn), np.sin(turn)
    placed = [
        (kind, support, (cos * x - sin * y + dx, sin * x + cos * y + dy, z), half, yaw + turn)
        for kind, support, (x, y, z), half, yaw in things
    ]
    return observed(placed)


def query(scene: ObservedScene, category: int, *allowed: int) -> Query:
    return Query(scene, category, None, np.isin(np.arange(len(scene.yaw)), allowed), {})  # type: ignore[arg-type]


def bottom(scene: ObservedScene, obj: int) -> np.ndarray:
    return scene.center[obj] - (0, 0, scene.half[obj, 2])


def test_offsets_lead_from_the_support_back_to_the_thing() -> None:
    scene = moved(THINGS, 3.0, -2.0, 0.8)
    for obj, (x, y, height, turn) in enumerate(offsets(scene)):
        support = int(scene.support[obj])
        if support < 0:
            np.testing.assert_allclose([x, y, height, turn], [*bottom(scene, obj), scene.yaw[obj]])
            continue
        yaw = scene.yaw[support]
        along, across = np.array([np.cos(yaw), np.sin(yaw)]), np.array([-np.sin(yaw), np.cos(yaw)])
        np.testing.assert_allclose(scene.center[support, :2] + x * along + y * across, scene.center[obj, :2])
        assert bottom(scene, support)[2] + height == pytest.approx(bottom(scene, obj)[2])
        assert yaw + turn == pytest.approx(scene.yaw[obj])


def test_the_mean_of_rooms_that_are_alike_is_where_things_stood_in_them_wherever_the_room_is() -> None:
    proposer = GaussianProposer([moved(THINGS, 1.0, 2.0, 0.3), moved(THINGS, -4.0, 0.5, -1.9)], spread=0.0)
    scene = moved(THINGS, -3.0, 5.0, 2.1)
    table = proposer.propose(query(scene, TABLE, 0), 3, np.random.default_rng(0))
    assert table.support.tolist() == [0] * 3
    np.testing.assert_allclose(table.places[:, :3], [bottom(scene, 4)] * 3, atol=1e-9)
    np.testing.assert_allclose(np.exp(1j * table.places[:, 3]), np.exp(1j * scene.yaw[[4] * 3]), atol=1e-9)
    cups = proposer.propose(query(scene, CUP, 4), 1, np.random.default_rng(0)).places[0]
    np.testing.assert_allclose(cups[:3], np.mean([bottom(scene, obj) for obj in CUPS], axis=0), atol=1e-9)
    turn = np.angle(np.exp(1j * scene.yaw[list(CUPS)]).mean())
    assert np.exp(1j * cups[3]) == pytest.approx(np.exp(1j * turn))


def test_draws_have_the_spread_that_was_seen() -> None:
    proposer = GaussianProposer([observed(THINGS)])
    scene = moved(THINGS, 0.0, 0.0, 1.3)
    places = proposer.propose(query(scene, CHAIR, 0), 4000, np.random.default_rng(1)).places
    yaw = scene.yaw[0]
    back = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
    along = (places[:, :2] - scene.center[0, :2]) @ back.T
    seen = offsets(observed(THINGS))[list(CHAIRS)]
    np.testing.assert_allclose(along.mean(axis=0), seen[:, :2].mean(axis=0), atol=0.06)
    np.testing.assert_allclose(along.std(axis=0), np.maximum(seen[:, :2].std(axis=0), SPREAD_FLOOR), rtol=0.05)
    assert places[:, 2].std() == pytest.approx(
        SPREAD_FLOOR, rel=0.05
    )  # both stood on the floor: the least that is said
    resultant = abs(np.exp(1j * seen[:, 3]).mean())
    assert places[:, 3].std() == pytest.approx(np.sqrt(-2 * np.log(resultant)), rel=0.05)


def test_supports_are_drawn_by_how_often_they_held_such_a_thing() -> None:
    things = [*THINGS, (CUP, 7, (-0.7, -0.5, 0.96), (0.05, 0.04, 0.06), 0.0)]  # two cups on the table, one on a chair
    proposer = GaussianProposer([observed(things)])
    found = proposer.propose(query(observed(things), CUP, 4, 7, 8), 3000, np.random.default_rng(2)).support
    shares = [float((found == obj).mean()) for obj in (4, 7, 8)]
    np.testing.assert_allclose(shares, [2 / 3, 1 / 6, 1 / 6], atol=0.03)  # two chairs share what chairs have
    nowhere = proposer.propose(query(observed(things), CUP), 5, np.random.default_rng(3))
    assert nowhere.support.tolist() == [-1] * 5
    elsewhere = proposer.propose(query(observed(things), CUP, 4, 0), 3000, np.random.default_rng(2)).support
    assert (elsewhere == 0).mean() == pytest.approx(0.1 / 2.1, abs=0.015)  # never seen there: a tenth of once


def test_log_densities_are_those_of_their_normal_distributions() -> None:
    scene = moved(THINGS, 1.0, -1.0, 0.4)
    proposer = GaussianProposer([observed(THINGS), moved(THINGS, 0.0, 0.0, 0.0)])
    seen = offsets(observed(THINGS))[list(CHAIRS)]
    at = np.array([0.5, -0.7, 0.0, 0.9])
    yaw = scene.yaw[0]
    back = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
    expected = norm.logpdf(
        back @ (at[:2] - scene.center[0, :2]), seen[:, :2].mean(axis=0), seen[:, :2].std(axis=0)
    ).sum()
    resultant = np.exp(1j * seen[:, 3]).mean()
    turn, deviation = np.angle(resultant), np.sqrt(-2 * np.log(abs(resultant)))
    expected += np.log(sum(norm.pdf(at[3] - yaw - turn + 2 * np.pi * k, 0, deviation) for k in range(-3, 4)))
    assert proposer.log_density(query(scene, CHAIR, 0), 0, at) == pytest.approx(expected)
    free = proposer.log_density(query(scene, FLOOR), -1, np.array([0.3, -0.2, 0.0, 0.0]))
    assert free == pytest.approx(2 * norm.logpdf(0, 0, SPREAD_FLOOR) + norm.logpdf(0, 0, 0.01))


@pytest.mark.parametrize("kind", [GaussianProposer, WorldGaussianProposer])
def test_densities_integrate_to_one(kind: type) -> None:
    scene = observed(THINGS)
    proposer, asked = kind([scene]), query(scene, CHAIR, 0)
    grid = np.linspace(-5, 5, 41)
    turns = np.linspace(-np.pi, np.pi, 9, endpoint=False)
    values = [proposer.log_density(asked, 0, np.array([x, y, 0, t])) for x in grid for y in grid for t in turns]
    assert np.exp(values).sum() * (grid[1] - grid[0]) ** 2 * (turns[1] - turns[0]) == pytest.approx(1, abs=0.02)


def test_in_the_room_things_stand_where_they_stood_from_its_middle() -> None:
    proposer = WorldGaussianProposer([moved(THINGS, 2.0, 1.0, 0.0), moved(THINGS, -2.0, 3.0, 0.0)])
    scene = moved(THINGS, 7.0, -4.0, 0.0)
    places = proposer.propose(query(scene, TABLE, 0, 4), 2000, np.random.default_rng(4))
    np.testing.assert_allclose(places.places[:, :3].mean(axis=0), bottom(scene, 4), atol=0.002)
    assert set(places.support) == {0}
    chairs = proposer.propose(query(scene, CHAIR, 0), 2000, np.random.default_rng(4)).places
    ends = np.array([bottom(scene, obj) for obj in CHAIRS])
    np.testing.assert_allclose(chairs[:, :2].std(axis=0), np.abs(ends[0] - ends[1])[:2] / 2, rtol=0.06)
    inside = proposer.log_density(query(scene, TABLE, 0), 0, np.append(bottom(scene, 4), scene.yaw[4]))
    assert inside == pytest.approx(2 * norm.logpdf(0, 0, SPREAD_FLOOR) + norm.logpdf(0, 0, 0.01))


def test_copies_stand_where_one_stood_and_the_nearest_room_is_the_one_like_it() -> None:
    fuller = [*THINGS, (CUP, 4, (-0.3, 0.5, 0.86), (0.05, 0.04, 0.06), 0.2)]
    rooms = [moved(THINGS, 2.0, 1.0, 0.0), observed(fuller)]
    scene = moved(fuller, -1.0, 4.0, 0.0)
    both = CopyProposer(rooms, len(VOCABULARY), False).propose(query(scene, CUP, 4), 400, np.random.default_rng(5))
    stood = {tuple(np.round([*bottom(scene, obj), scene.yaw[obj]], 6)) for obj in (*CUPS, 10)}
    assert {tuple(np.round(place, 6)) for place in both.places} == stood
    assert set(both.support) == {4}
    nearest = CopyProposer(rooms, len(VOCABULARY), True)
    assert len(np.unique(nearest.propose(query(scene, CUP, 4), 400, np.random.default_rng(5)).places[:, 0])) == 3
    bare = moved(THINGS, 0.0, 0.0, 0.0)
    assert len(np.unique(nearest.propose(query(bare, CUP, 4), 400, np.random.default_rng(5)).places[:, 0])) == 2
    unknown = nearest.propose(query(scene, len(VOCABULARY) - 1 + 5, 0), 2, np.random.default_rng(5))
    np.testing.assert_allclose(unknown.places, [[*scene.room.middle, scene.room.ground, 0.0]] * 2)


@pytest.mark.parametrize(
    ("place", "expected"),
    [
        ((-0.6, 0.4, 0.8), 4),  # on the table
        ((-0.6, 0.4, 0.82), 4),
        ((2.0, -1.9, 0.0), 0),  # on the floor
        ((-0.7, -0.5, 0.9), 7),  # on the chair
        ((-1.45, 0.4, 0.81), 4),  # a little beside the table, and as high
    ],
)
def test_what_is_nearest_below_carries(place: tuple[float, ...], expected: int) -> None:
    scene = observed(THINGS)
    allowed = np.isin(scene.category, (FLOOR, TABLE, CHAIR))
    assert carrier_of(scene, np.array([*place, 0.0]), allowed) == expected
    assert carrier_of(scene, np.array([*place, 0.0]), np.zeros(len(THINGS), bool)) == -1
    assert carrier_of(scene, np.array([*place, 0.0]), scene.category == WALL) in (1, 2)


def test_rooms_are_alike_by_counts_and_size() -> None:
    graph = living_room(3)
    found = signature(graph, ["Chair", "Floor", "Nothing"])
    names = [graph.category_name(row) for row in range(len(graph))]
    assert found[:3].tolist() == [names.count("Chair"), 1, 0]
    floor = names.index("Floor")
    points = graph.meshes[graph.mesh[floor]].points @ graph.world[floor, :3, :3].T
    np.testing.assert_allclose(found[3:], 2 * np.ptp(points, axis=0)[:2], rtol=1e-5)
    assert signature(graph.replace(vocabulary=(), category=graph.category * 0 - 1), ["Chair"]).tolist() == [0, 0, 0]
    others = np.array([[0, 0.0], [3, 1], [1, 1]])
    assert nearest_room(np.array([2, 1.0]), others).tolist() == [1, 2, 0]

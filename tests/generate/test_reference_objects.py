"""Reference objects: what tells where others are, found among things that are anywhere."""

from __future__ import annotations

import numpy as np
import pytest

from unisg_blender.generate.observe.reference_objects import FEWEST, find_reference_objects
from unisg_blender.geometry.boxes import Boxes
from unisg_blender.spatial.objects import SceneObjects

VOCABULARY = ["Floor", "Bed", "Lamp", "Desk", "Chair", "Plant"]
FLOOR, BED, LAMP, DESK, CHAIR, PLANT = range(6)


def objects(things: list[tuple[int, float, float, float]], size: float = 0.5) -> SceneObjects:
    """A floor with things on it: category, x, y, turn."""
    category = np.array([FLOOR, *(kind for kind, *_ in things)])
    center = np.array([(0, 0, 0), *((x, y, 0.5) for _, x, y, _ in things)], float)
    nothing = Boxes(np.zeros((0, 3)), np.zeros((0, 3, 3)), np.zeros((0, 3)), np.zeros(0, bool))
    count, half = len(category), np.full((len(category), 3), size)
    support = np.array([-1, *[0] * len(things)])
    yaw = np.array([0.0, *(turn for *_, turn in things)])
    return SceneObjects(
        np.arange(count), category, support, center, half, yaw, nothing, np.zeros(0, int), ("",) * count
    )


def rooms(count: int, spread: float, twice: int = -1, seed: int = 0) -> list[SceneObjects]:
    """A bed anywhere with a lamp at its side, a plant anywhere; ``twice``: of this there are two."""
    found = []
    for number in range(count):
        rng = np.random.default_rng((seed, number))
        (x, y), turn = rng.uniform(-3, 3, 2), rng.uniform(-np.pi, np.pi)
        side = np.array([1.2, 0.4]) + rng.normal(0, spread, 2)
        lamp = [
            x + np.cos(turn) * side[0] - np.sin(turn) * side[1],
            y + np.sin(turn) * side[0] + np.cos(turn) * side[1],
        ]
        things = [(BED, x, y, turn), (LAMP, *lamp, 0.0), (PLANT, *rng.uniform(-3, 3, 2), 0.0)]
        if twice >= 0:
            things.append((twice, *rng.uniform(-3, 3, 2), 0.0))
        found.append(objects(things))
    return found


def test_the_bed_tells_where_its_lamp_is() -> None:
    assert find_reference_objects(rooms(40, 0.02), VOCABULARY) == ["Bed"]


def test_nothing_tells_where_what_is_anywhere_is() -> None:
    assert find_reference_objects(rooms(40, 3.0), VOCABULARY) == []


def test_what_is_there_twice_tells_nothing_and_is_told() -> None:
    assert find_reference_objects(rooms(40, 0.02, twice=BED), VOCABULARY) == []
    assert find_reference_objects(rooms(40, 0.02, twice=PLANT), VOCABULARY) == ["Bed"]


def test_few_rooms_say_nothing() -> None:
    assert find_reference_objects(rooms(FEWEST - 1, 0.02), VOCABULARY) == []
    assert find_reference_objects(rooms(FEWEST, 0.02), VOCABULARY) == ["Bed"]


def test_a_reference_that_is_seldom_there_tells_too_little() -> None:
    seldom = rooms(FEWEST, 0.02) + [objects([(PLANT, 1.0, 0.1 * number, 0.0)]) for number in range(60)]
    assert find_reference_objects(seldom, VOCABULARY) == []


@pytest.mark.parametrize("way", ["held by things", "without size", "unknown"])
def test_only_known_things_with_a_size_on_the_floor_count(way: str) -> None:
    found = rooms(40, 0.02)
    for room in found:
        if way == "held by things":
            room.support[2] = 1
        elif way == "without size":
            room.half[2] = 0
        else:
            room.category[2] = -1
    assert find_reference_objects(found, VOCABULARY) == []


def test_two_references_come_by_how_much_they_tell() -> None:
    found = []
    for number in range(40):
        rng = np.random.default_rng((7, number))
        (x, y), (u, v) = rng.uniform(-3, 3, 2), rng.uniform(-3, 3, 2)
        found.append(objects([
            (BED, x, y, 0.0), (LAMP, x + 1 + rng.normal(0, 0.02), y + rng.normal(0, 0.02), 0.0),
            (PLANT, x - 1 + rng.normal(0, 0.02), y + rng.normal(0, 0.02), 0.0),
            (DESK, u, v, 0.0), (CHAIR, u + rng.normal(0, 0.02), v - 1 + rng.normal(0, 0.02), 0.0),
        ]))  # fmt: skip
    first, *others = find_reference_objects(found, VOCABULARY)
    assert first in ("Bed", "Lamp", "Plant")  # each tells where the two others are
    assert len(set(others) & {"Desk", "Chair"}) == 2  # each tells where the other is
    assert len(set(others) & {"Bed", "Lamp", "Plant"}) == 1  # and a second one where the first is
    assert find_reference_objects(found[::-1], VOCABULARY) == [first, *others]

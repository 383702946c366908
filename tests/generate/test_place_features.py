"""What trees see of a place is what one measures with corners, one place and one thing at a time."""

from __future__ import annotations

import numpy as np
import pytest

from tests.generate.hand_made_room import (
    BUILDING,
    CHAIR,
    CUP,
    DOOR,
    FLOOR,
    TABLE,
    THINGS,
    VOCABULARY,
    WALL,
    observed,
)  # fmt: skip
from unisg_blender.generate.observe.observed_scene import ObservedScene
from unisg_blender.generate.observe.prior_tables import PriorTables
from unisg_blender.generate.observe.room_walls import RoomWalls
from unisg_blender.generate.observe.support_priors import CategoryPriors, SupportPrior
from unisg_blender.generate.propose.place_features import FAR, LANDMARKS, CategoryKinds, place_features
from unisg_blender.generate.propose.plain_proposals import TriedRoom
from unisg_blender.generate.propose.proposer import Proposals


def tables() -> PriorTables:
    return PriorTables.of(CategoryPriors({}, {}, {}, []), VOCABULARY)


KINDS = CategoryKinds(np.array([3, 1, 4, 0, 5, 2, 6]), (TABLE, CHAIR), (DOOR, -2))


def corners(center: np.ndarray, half: np.ndarray, yaw: float) -> np.ndarray:
    along, across = np.array([np.cos(yaw), np.sin(yaw)]), np.array([-np.sin(yaw), np.cos(yaw)])
    return np.array([center[:2] + i * half[0] * along + j * half[1] * across for i in (-1, 1) for j in (-1, 1)])


def seen(points: np.ndarray, origin: np.ndarray, yaw: float) -> np.ndarray:
    """Points in the frame of something that stands at an origin, turned."""
    off = points - origin[:2]
    x, y = np.array([np.cos(yaw), np.sin(yaw)]), np.array([-np.sin(yaw), np.cos(yaw)])
    return np.stack([off @ x, off @ y], axis=-1)


def clearances(box: np.ndarray, half: np.ndarray, origin: np.ndarray, yaw: float) -> tuple[float, float]:
    """From the rectangle around an origin to corners (4, 2), along its own axes; negative where they overlap."""
    there = seen(box, origin, yaw)
    low, high = there.min(axis=0), there.max(axis=0)
    apart = np.maximum(low - half[:2], -half[:2] - high)
    return float(apart[0]), float(apart[1])


def expected(scene: ObservedScene, half: np.ndarray, category: int, place: np.ndarray, support: int) -> list[float]:
    """All features of a place, each by its own description."""
    yaw, ground = float(place[3]), scene.center[0, 2] + scene.half[0, 2]
    others = [k for k in range(len(scene.yaw)) if scene.category[k] not in (FLOOR, WALL)]
    mine = corners(place, half, yaw)
    gap, far, high, local, apart = {}, {}, {}, {}, {}
    for k in others:
        theirs = corners(scene.center[k], scene.half[k], scene.yaw[k])
        apart[k] = clearances(theirs, half, place, yaw)
        gap[k] = max(*apart[k], *clearances(mine, scene.half[k], scene.center[k], scene.yaw[k]))
        local[k] = seen(scene.center[k, :2], place, yaw)
        far[k] = float(np.linalg.norm(scene.center[k, :2] - place[:2]))
        low, top = scene.center[k, 2] - scene.half[k, 2], scene.center[k, 2] + scene.half[k, 2]
        high[k] = low < place[2] + 2 * half[2] - 0.005 and top > place[2] + 0.005
    found = [float(KINDS.rank[category]), *half, round((place[2] - ground) / 0.1) * 0.1]
    walls = RoomWalls.of(scene, tables())
    wall_gap, normal = (part[0] for part in walls.gaps(place[None], half))
    for w in np.argsort(wall_gap)[:2]:
        found += [wall_gap[w], np.cos(yaw - normal[w]), np.sin(yaw - normal[w])]
    for axis, sign in ((1, 1), (1, -1), (0, 1), (0, -1)):
        clear = [apart[k][axis] for k in others if high[k] and local[k][axis] * sign > 0 and apart[k][1 - axis] < 0]
        turn = yaw + (0 if axis == 0 else np.pi / 2)
        looks = [-sign * float(np.cos(n - turn)) > 0.9 for n in normal]
        found.append(min([FAR, *clear, *(wall_gap[w] for w in range(len(normal)) if looks[w])]))
    level = [k for k in others if high[k] and k != support]
    alike = [k for k in others if scene.category[k] == category]
    doors = [k for k in others if scene.category[k] == DOOR]
    found += [min([FAR, *(gap[k] for k in level)]), min([FAR, *(far[k] for k in alike)])]
    found += [min([FAR, *(gap[k] for k in alike)]), min([FAR, *(gap[k] for k in doors)]), FAR]
    found.append(sum(gap[k] < 1 for k in level))
    found += on(scene, half, category, place, support)
    kept = [k for k in others if k != support and scene.category[k] != DOOR]
    nearest = min(kept, key=lambda k: gap[k] + (not high[k]), default=-1)
    if nearest < 0 or gap[nearest] + (not high[nearest]) >= FAR:
        found += [-1, FAR, FAR, 0, 0]
    else:
        there = seen(place[:2], scene.center[nearest], scene.yaw[nearest])
        bearing = local[nearest][1] / max(far[nearest], 1e-6)
        rank = KINDS.rank[scene.category[nearest]]
        found += [rank, abs(there[0]), there[1], np.cos(yaw - scene.yaw[nearest]), bearing]
    for landmark in KINDS.landmarks:
        same = [k for k in others if scene.category[k] == landmark]
        found += [min([FAR, *(far[k] for k in same)]), min([FAR, *(gap[k] for k in same)])]
    return [*found, *[FAR] * 2 * (LANDMARKS - len(KINDS.landmarks))]


def on(scene: ObservedScene, half: np.ndarray, category: int, place: np.ndarray, support: int) -> list[float]:
    if support < 0:
        return [-1.0] * 14
    center, size, yaw = scene.center[support], scene.half[support], float(scene.yaw[support])
    offset, rise = seen(place[:2], center, yaw), (place[2] - center[2]) / 0.1
    own = seen(corners(place, half, float(place[3])), center, yaw)
    edge = [size[axis] - np.abs(own[:, axis]).max() for axis in (0, 1)]
    held = [k for k in range(len(scene.yaw)) if scene.support[k] == support and scene.category[k] not in BUILDING]
    area = sum(4 * scene.half[k, 0] * scene.half[k, 1] for k in held) / (4 * size[0] * size[1] + 1e-6)
    turn, top = float(place[3]) - yaw, (center[2] + size[2] - place[2]) / 0.1
    return [
        float(KINDS.rank[scene.category[support]]), round(rise) * 0.1, *(offset / size[:2]), min(edge), max(edge),
        np.cos(turn), np.sin(turn), *size[:2], area, len(held),
        sum(scene.category[k] == category for k in held), round(top) * 0.1,
    ]  # fmt: skip


PLACES = np.array([
    [-0.1, 1.1, 0.0, 0.2], [1.0, -0.3, 0.0, 1.9], [2.4, 1.4, 0.0, -2.2], [-0.75, 0.5, 0.8, 0.9], [-2.3, -1.9, 0.0, 3.0],
    [-0.45, 0.25, 0.8, -2.6], [1.25, 1.7, 0.3, np.pi], [0.0, 0.0, 9.0, 0.0], [-0.6, 0.4, 0.05, 0.4],
])  # fmt: skip
SUPPORTS = np.array([0, 0, -1, 4, 0, 4, 0, -1, 4])


@pytest.mark.parametrize("category", [CUP, CHAIR, DOOR])
@pytest.mark.parametrize("half", [(0.31, 0.17, 0.2), (0.06, 0.09, 0.04)])
def test_every_number_is_what_it_says(category: int, half: tuple[float, ...]) -> None:
    scene, size = observed(THINGS), np.array(half)
    room = TriedRoom.of(scene, tables())
    found = place_features(room, KINDS, category, size, Proposals(SUPPORTS, PLACES))
    wanted = [expected(scene, size, category, place, int(obj)) for place, obj in zip(PLACES, SUPPORTS, strict=True)]
    np.testing.assert_allclose(found, np.clip(wanted, -FAR, 1e3), atol=2e-5)


def test_what_is_not_there_is_not_seen() -> None:
    scene, half = observed(THINGS), np.array([0.3, 0.2, 0.2])
    shown = np.ones(len(THINGS), bool)
    shown[[5, 8]] = False
    part = observed([thing for thing, there in zip(THINGS, shown, strict=True) if there])
    proposals = Proposals(SUPPORTS, PLACES)
    number = np.append(np.cumsum(shown) - 1, -1)
    less = place_features(TriedRoom.of(scene, tables(), shown), KINDS, CHAIR, half, proposals)
    without = place_features(TriedRoom.of(part, tables()), KINDS, CHAIR, half, Proposals(number[SUPPORTS], PLACES))
    np.testing.assert_allclose(less, without, atol=1e-6)
    whole = place_features(TriedRoom.of(scene, tables()), KINDS, CHAIR, half, proposals)
    assert not np.allclose(less, whole)


def test_an_empty_room_has_nothing_near() -> None:
    scene, half = observed(THINGS[:1]), np.array([0.3, 0.2, 0.2])
    found = place_features(TriedRoom.of(scene, tables()), KINDS, CHAIR, half, Proposals(np.array([0]), PLACES[:1]))[0]
    assert (found[15:20] == FAR).all()  # nothing to meet, none of its own kind, no door, no window
    assert found[20] == 0
    np.testing.assert_array_equal(found[35:40], [-1, FAR, FAR, 0, 0])
    assert (found[40:] == FAR).all()


def test_categories_are_in_an_order_in_which_alike_ones_are_near() -> None:
    supports = {
        "Table": (SupportPrior("Floor", 9, "rests"),),
        "Chair": (SupportPrior("Floor", 20, "rests"), SupportPrior("Table", 1, "rests")),
        "Cup": (SupportPrior("Table", 30, "rests"), SupportPrior("Floor", 29, "rests")),
        "Floor": (SupportPrior("", 5, "rests"),),
        "Wall": (SupportPrior("Floor", 50, "rests"),),
    }
    found = PriorTables.of(CategoryPriors(supports, {}, {}, []), VOCABULARY)
    sizes = {"Table": (1.4, 0.8, 0.8), "Chair": (0.5, 0.6, 0.9), "Cup": (0.1, 0.1, 0.1)}
    sizes |= {"Wall": (6, 0.1, 2.5), "Floor": (6, 5, 0.1)}
    kinds = CategoryKinds.of(found, sizes, VOCABULARY)
    # wholly on floors or the ground: the largest first; then by how often; what was never seen last
    by_rank = [VOCABULARY[k] for k in np.argsort(kinds.rank[:-1])]
    assert by_rank == ["Floor", "Wall", "Table", "Chair", "Cup", "Door"]
    assert kinds.rank[-1] == len(VOCABULARY)
    assert kinds.landmarks == (CHAIR, TABLE)  # what stands on floors mostly, the commonest first, and is no building
    assert kinds.openings == (DOOR, -2)
    assert CategoryKinds.of(found, sizes, ["Window", *VOCABULARY[1:]]).openings == (DOOR, 0)

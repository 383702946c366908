"""Where a thing would stand for whoever points at a place, and what is wrong there."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ...geometry.arrays import Floats
from ..check.pose_check import posed_thing
from ..check.surroundings import PosedThing
from ..observe.support_priors import INSIDE, RESTS
from ..place.proposal_selection import settle
from ..propose.place_sampling import USUAL, Sampling
from ..propose.proposer import Proposals
from ..propose.requests import Beside
from .nearby_places import MOST, appeal, best_near, distances
from .placing_room import PlacingRoom

FAR, LEVEL = 0.4, 0.03
"""Metres from the nearest place of the map at which the model says nothing of a point, and from what is level below."""

TRIED = 3
"""Places that are looked at until nothing is wrong with one."""

UNLIKELY = "the model would not put it here"


@dataclass(frozen=True, eq=False)
class Ghost:
    """Where the thing would stand: its ``place`` (4,), what holds it (-1: the ground) and its matrix (4, 4).

    ``wrong`` says what is wrong, ``note`` what else is to be said.
    """

    place: Floats
    support: int
    world: Floats
    wrong: tuple[str, ...] = ()
    note: str = ""


def ghost_near(room: PlacingRoom, point: Floats, number: int = 0) -> Ghost | None:
    """At the ``number``-th likely place near a point (3,), counted round and round; None where none near it fits.

    The first one may be the very point, between the places of the map.
    """
    away = distances(room.map, point)
    numbers = best_near(room.map, away, MOST if number else TRIED, float(np.hypot(*room.target.placeable.half[:2])))
    own = _at(room, point) if number == 0 else None
    if own is not None:
        best = appeal(room.map.log_density[numbers[:1]], away[numbers[:1]]).max(initial=-np.inf)
        if appeal(room.map.log_density[[own[0]]], float(away.min()))[0] >= best:
            ghost = _ghost(room, own[1], *_of(room, own[0]))
            if not ghost.wrong or not len(numbers):
                return ghost
    if not len(numbers):
        return None
    first = number % len(numbers)
    ghosts = (_ghost(room, room.map.places[each], *_of(room, each)) for each in numbers[first : first + TRIED].tolist())
    found = [next(ghosts)]
    while found[-1].wrong and number == 0 and (other := next(ghosts, None)) is not None:
        found.append(other)
    return found[0] if found[-1].wrong else found[-1]


def ghost_by_hand(room: PlacingRoom, point: Floats, yaw: float | None = None, level: bool = True) -> Ghost:
    """At the very point (3,) with a turn in radians, or None for that of the nearest place of the map.

    Where what is pointed at is not ``level``, such as a wall, it is settled onto what would hold it.
    """
    nearest = _nearest(room, point)
    support, density = _of(room, nearest) if nearest >= 0 else (_under(room, point), -np.inf)
    usual = float(room.map.places[nearest, 3]) if nearest >= 0 else 0.0
    place = np.append(point, usual if yaw is None else yaw)
    if not level:
        place[2] -= room.target.placeable.half[2]
        place = settle(room.scene, room.target, Proposals(np.array([support]), place[None]))[0].places[0]
    return _ghost(room, place, support, density)


def ghost_at(room: PlacingRoom, place: Floats) -> Ghost:
    """At a place (4,) as it is given, on what would hold it there."""
    nearest = _nearest(room, place[:3])
    support, density = _of(room, nearest) if nearest >= 0 else (_under(room, place[:3]), -np.inf)
    return _ghost(room, place, support, density)


def ghost_anywhere(room: PlacingRoom, rng: np.random.Generator, sampling: Sampling = USUAL) -> Ghost | None:
    """At a place of the room, drawn by how likely it is; None where none fits."""
    likely = np.where(room.map.fits, room.map.log_density, -np.inf)
    if not np.isfinite(best := likely.max(initial=-np.inf)):
        return None
    mass = np.exp(sampling.power * (likely - best)) * room.map.cells.area
    chosen = int(rng.choice(len(mass), p=mass / mass.sum()))
    return _ghost(room, room.map.places[chosen], *_of(room, chosen))


def _of(room: PlacingRoom, number: int) -> tuple[int, float]:
    """What holds a place of the map, and its log-density."""
    return int(room.map.support[number]), float(room.map.log_density[number])


def _nearest(room: PlacingRoom, point: Floats) -> int:
    """The number of the place of the map nearest to a point, -1 where it is far."""
    away = distances(room.map, point)
    best = int(away.argmin()) if len(away) else -1
    return best if best >= 0 and away[best] < FAR else -1


def _at(room: PlacingRoom, point: Floats) -> tuple[int, Floats] | None:
    """The place (4,) at the very point, held and turned as the nearest one of the map, if it fits; and that one."""
    nearest = _nearest(room, point)
    if nearest < 0 or room.map.hangs[nearest]:
        return None
    place = room.map.places[nearest].copy()
    place[:2] += point[:2] - room.map.aim[nearest, :2]
    settled, good = settle(room.scene, room.target, Proposals(room.map.support[[nearest]], place[None]))
    return (nearest, settled.places[0]) if good[0] else None


def _under(room: PlacingRoom, point: Floats) -> int:
    """The number of what is level at a point (3,); the floor where nothing is, -1 for the ground without one."""
    for obj in range(len(room.scene.labels)):
        tops = room.scene.support(room.target.category, obj).tops
        across = np.stack([-tops.along[:, 1], tops.along[:, 0]], axis=1)
        off = point[:2] - tops.center
        own = np.abs(np.stack([(off * tops.along).sum(axis=1), (off * across).sum(axis=1)], axis=1))
        if ((own <= tops.half).all(axis=1) & (np.abs(tops.top - point[2]) < LEVEL)).any():
            return obj
    return next((number for number, label in enumerate(room.scene.labels) if label.floor), -1)


def _ghost(room: PlacingRoom, place: Floats, support: int, density: float) -> Ghost:
    note = room.note or ("" if np.isfinite(density) else UNLIKELY)
    wrong = _with_wishes(room, place, support, room.check.reason(_posed(room, place, support)))
    return Ghost(place, support, room.target.placeable.world(place), wrong, note)


def measured(room: PlacingRoom, ghost: Ghost) -> Ghost:
    """The ghost with by how much it collides or floats, and whether it cuts the way: takes up to tenths of a second."""
    told = room.check.measured(_posed(room, ghost.place, ghost.support), room.wanted.category)
    return replace(ghost, wrong=_with_wishes(room, ghost.place, ghost.support, told))


def _posed(room: PlacingRoom, place: Floats, support: int) -> PosedThing:
    contact = room.scene.support(room.target.category, support).contact
    holder = room.scene.labels[support].uid if contact != RESTS and support >= 0 else ""
    return posed_thing(room.check, room.target.placeable, room.triangles, place, holder, contact == INSIDE)


def _with_wishes(room: PlacingRoom, place: Floats, support: int, fault: str) -> tuple[str, ...]:
    """What is wrong with a place (4,): what the check says, and what was wished."""
    found, half = [fault] if fault else [], room.target.placeable.half
    if room.wanted.on and not (support >= 0 and room.holders[support]):
        found.append(f"is not on {room.wanted.on}")
    if room.beside >= 0 and not Beside(room.generator.proposer, room.beside).has(room.scene.observed, half, place):
        found.append(f"is not beside {room.wanted.beside}")
    return tuple(found)

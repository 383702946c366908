"""Where a model would put an object: its density over floor, boards and walls as places that are settled and tested."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...geometry.arrays import Bools, Floats, Ints
from ..observe.support_candidates import SupportOccupancy
from ..observe.support_priors import AT_SIDE, RESTS
from ..place.growing_scene import GrowingScene, Target
from ..place.proposal_selection import settle
from ..propose.proposer import NOTHING_ELSE, Proposals, Proposer, Query, SupportChoice
from .surface_cells import TINY, SurfaceCells, joined_cells, level_cells, single_points, wall_cells

ENOUGH, MOST = 0.998, 12
"""Supports are looked at, the likeliest first, until they have this share of the chance, and so many at most."""

DRAWN, POINT = 96, 0.03
"""Places that are drawn where something neither stands nor is at a wall, and half the side of what is drawn of each,
metres."""

TOGETHER = 128
"""Places that are settled at a time."""

SCALE, LEAST = 8.0, 0.01
"""Nats below the likeliest cell at which a place is cold, and the heat of what is cold and yet free."""


@dataclass(frozen=True, eq=False)
class PlaceMap:
    """N places for one object.

    Attributes
    ----------
    places
        (N, 4) x, y, bottom and turn, settled.
    support
        int64 (N,): what holds it there, -1 the ground.
    log_density
        (N,) nats per m2 of surface: what the model says.
    fits
        bool (N,): where it touches nothing and is in the room.
    aim
        (N, 3): what one points at to mean it, on the floor or board, or at a wall the middle of the object.
    hangs
        bool (N,): where it hangs from above, and its height says nothing of where one points.
    cells
        What is drawn of each place: on its surface; nothing of those that were drawn by chance beside the cells.
    """

    places: Floats
    support: Ints
    log_density: Floats
    fits: Bools
    aim: Floats
    hangs: Bools
    cells: SurfaceCells

    def __len__(self) -> int:
        return len(self.places)

    @cached_property
    def heat(self) -> Floats:
        """From 0 to 1 (N,): how likely each place is, beside the likeliest cell that fits; 0 where it does not fit."""
        shown = self.fits & (self.cells.area > TINY)
        chosen = self.log_density[shown if shown.any() else self.fits]
        if not len(chosen):
            return np.zeros(len(self))
        return np.where(self.fits, np.clip(1 + (self.log_density - chosen.max()) / SCALE, LEAST, 1), 0.0)


def place_map(
    scene: GrowingScene, proposer: Proposer, target: Target, allowed: Bools, rng: np.random.Generator
) -> PlaceMap:
    """The places for a target on what may hold it, bool (K,)."""
    query = scene.query(target, allowed, {})
    choice = proposer.choose(query, SupportOccupancy.of(scene.observed)) if query.allowed.any() else None
    found = [
        part
        for obj, surface, chance in _candidates(scene, query, choice)
        if (part := _on_candidate(scene, proposer, target, query, choice, (obj, surface), chance, rng)) is not None
    ]
    if not found:
        none, yes = np.zeros(0), np.zeros(0, bool)
        return PlaceMap(np.zeros((0, 4)), none.astype(np.int64), none, yes, np.zeros((0, 3)), yes, joined_cells([]))
    cells = joined_cells([part.cells for part in found])
    names = ("places", "support", "log_density", "fits", "aim", "hangs")
    return PlaceMap(**{name: np.concatenate([getattr(part, name) for part in found]) for name in names}, cells=cells)


def _candidates(scene: GrowingScene, query: Query, choice: SupportChoice | None) -> list[tuple[int, int, float]]:
    """Objects and their surfaces with their chances; each surface alike for a model that makes no choice."""
    if choice is None:
        holders = np.flatnonzero(query.allowed).tolist()
        pairs = [(obj, number) for obj in holders for number in range(max(len(scene.observed.surfaces(obj)), 1))]
        return [(*pair, 1.0 / len(pairs)) for pair in pairs] or [(-1, -1, 1.0)]
    chance = np.exp(choice.score)
    order = np.argsort(-chance, kind="stable")[:MOST]
    before = np.cumsum(chance[order]) - chance[order]
    kept = order[before < ENOUGH]
    numbers = zip(choice.candidates.obj[kept], choice.candidates.surface[kept], chance[kept], strict=True)
    return [(int(obj), int(surface), float(share)) for obj, surface, share in numbers]


def _on_candidate(
    scene: GrowingScene, proposer: Proposer, target: Target, query: Query, choice: SupportChoice | None,
    candidate: tuple[int, int], chance: float, rng: np.random.Generator,
) -> PlaceMap | None:  # fmt: skip
    """The places on one candidate, None where there are none: on its cells, and some that the model draws."""
    obj, surface = candidate
    support = scene.support(target.category, obj)
    drawn = proposer.propose_on(query, DRAWN, rng, candidate, NOTHING_ELSE, choice)
    if obj >= 0 and surface >= 0 and support.contact == RESTS:
        bottom = float(scene.observed.center[obj, 2] - scene.observed.half[obj, 2])
        height = bottom + float(scene.observed.surfaces(obj)[surface, 0])
        cells = joined_cells([level_cells(support, height, scene.space.outline), single_points(drawn.places)])
        density, yaw = proposer.density_on(query, cells.points[:, :2], height, candidate, rng)
        raw = np.column_stack([cells.points, yaw])
    elif obj >= 0 and support.contact == AT_SIDE and scene.tables.structural[scene.observed.category[obj]]:
        cells = wall_cells(support, scene.space.outline)
        density, raw = _at_wall(proposer, query, choice, cells, candidate, rng)
    else:
        raw, density, cells = drawn.places, np.zeros(DRAWN), single_points(drawn.places, POINT)
    if not len(raw):
        return None
    settled, fits = _settled(scene, target, obj, raw)
    density = density - np.logaddexp.reduce(density + np.log(cells.area)) + np.log(max(chance, 1e-12))
    at_side, hangs = obj >= 0 and support.contact == AT_SIDE, obj >= 0 and support.contact not in (RESTS, AT_SIDE)
    aim = settled.places[:, :3] + (0, 0, target.placeable.half[2] if at_side else 0.0)
    return PlaceMap(settled.places, settled.support, density, fits, aim, np.full(len(raw), hangs), cells)


def _settled(scene: GrowingScene, target: Target, obj: int, raw: Floats) -> tuple[Proposals, Bools]:
    """Places (N, 4) settled on an object, and which fit: some at a time, for what is side by side meets few things."""
    parts = np.array_split(raw, max(len(raw) // TOGETHER, 1))
    done = [settle(scene, target, Proposals(np.full(len(part), obj), part)) for part in parts]
    support, places = (np.concatenate([getattr(found, name) for found, _ in done]) for name in ("support", "places"))
    return Proposals(support, places), np.concatenate([good for _, good in done])


def _at_wall(
    proposer: Proposer, query: Query, choice: SupportChoice | None, cells: SurfaceCells, candidate: tuple[int, int],
    rng: np.random.Generator,
) -> tuple[Floats, Floats]:  # fmt: skip
    """Log-densities (N,) and places (N, 4) at the cells of a wall: along it, times that of the height."""
    half, bottoms = query.placeable.half, cells.points[:, 2] - query.placeable.half[2]
    low = float(query.scene.center[candidate[0], 2] - query.scene.half[candidate[0], 2])
    usual, above = float(np.median(bottoms)) if len(bottoms) else 0.0, np.zeros(len(bottoms))
    if choice is not None:
        number = int(choice.candidates.at(np.array([candidate[0]]), np.array([candidate[1]]))[0])
        weight, mean, sigma = choice.weight[number], choice.mean[number], choice.sigma[number]
        off = (bottoms[:, None] - low - mean) / sigma
        above = np.logaddexp.reduce(weight - off**2 / 2 - np.log(sigma), axis=1)
        usual = low + float(mean[weight.argmax()])
    before = cells.points[:, :2] + cells.normal[:, :2] * min(half[:2])
    along, inverse = np.unique(before.round(6), axis=0, return_inverse=True)
    density, yaw = proposer.density_on(query, along, usual, candidate, rng)
    each = inverse.reshape(-1)
    return density[each] + above, np.column_stack([before, bottoms, yaw[each]])

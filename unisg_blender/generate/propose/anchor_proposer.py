"""Places proposed by the anchor mixture and its critic: support first, then height, then position and heading."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.arrays import Bools, Floats
from ..observe.observed_scene import ObservedScene
from ..observe.scene_tokens import Arrays, coming_vector, context_arrays, plan_vector, tokens_for
from ..observe.support_candidates import Proximity, SupportCandidates, SupportOccupancy, support_arrays
from .mixture import OUT, behind_walls, draw_places, log_density, position_density, snapped
from .proposer import NOTHING_ELSE, Proposals, Proposer, Query, SupportChoice, Upcoming
from .trained_model import TrainedModel

MOST_CANDIDATES = 3
"""On how many different candidates at most proposals are made at a time."""

SLACK = 0.6
"""Left of such a turn for objects on the floor: cupboards stand along a wall to half a degree, books exactly."""

DRAWN, MANY = 64, 96
"""Places that are drawn, at least, among which the critic chooses; many for what stands on the floor or hangs on walls,
since whatever is placed later depends on it."""

CODES = 16
"""Latent codes over which a density is averaged."""

NORM = 64
"""Draws over which the critic's ratio is averaged to make it a density."""

SEEN = 3
"""Latent codes over which the density of a whole surface is averaged."""

PLACED = ("weight", "mean", "sigma", "heading", "kappa", "seen")
CHOSEN = ("support_score", "height_weight", "height_mean", "height_sigma")


class AnchorProposer(Proposer):
    """Draws from the model's densities with numpy."""

    def __init__(self, model: TrainedModel) -> None:
        self.model = model
        self.unknown = len(model.contract.vocabulary)

    def propose(self, query: Query, count: int, rng: np.random.Generator) -> Proposals:
        """``count`` proposals on candidates drawn by their probabilities; see :class:`~.proposer.Proposer`."""
        if not query.allowed.any():
            return self.propose_on(query, count, rng, (-1, -1), Upcoming(query.coming))
        choice = self.choose(query, SupportOccupancy.of(query.scene))
        chance = np.exp(choice.score)
        drawn = rng.choice(len(chance), size=min(MOST_CANDIDATES, count), p=chance / chance.sum())
        supports, places = np.zeros(count, np.int64), np.zeros((count, 4))
        for number in np.unique(drawn):
            mine = np.resize(drawn, count) == number
            candidate = int(choice.candidates.obj[number]), int(choice.candidates.surface[number])
            found = self.propose_on(query, int(mine.sum()), rng, candidate, NOTHING_ELSE, choice)
            supports[mine], places[mine] = candidate[0], found.places
        return Proposals(supports, places)

    def choose(self, query: Query, load: SupportOccupancy, whole: bool = False) -> SupportChoice:
        """See :class:`~.proposer.Proposer`."""
        half = query.placeable.half
        found = self._choice(query.scene, query.category, half, query.allowed, query.coming, load, whole)
        return replace(found, score=query.sampling.tempered(found.score))

    def support_chances(self, scene: ObservedScene, category: int, half: Floats, allowed: Bools) -> Floats:
        """The chance (K,) of each ``allowed`` object to hold a target: with what they hold already, nothing to come."""
        found = np.zeros(len(scene.category))
        if allowed.any():
            choice = self._choice(scene, category, half, allowed, {}, SupportOccupancy.of(scene))
            np.add.at(found, choice.candidates.obj, np.exp(choice.score))
        return found

    def _choice(
        self, scene: ObservedScene, category: int, half: Floats, allowed: Bools, coming: Mapping[int, int],
        load: SupportOccupancy, whole: bool = False,
    ) -> SupportChoice:  # fmt: skip
        may_hold = np.flatnonzero(allowed)
        candidates = scene.kept(f"candidates {may_hold.tolist()}", lambda: SupportCandidates.of(scene, may_hold))
        near = scene.kept(f"near {self.unknown}", lambda: self._near(scene))
        inputs = {
            **_batch(support_arrays(scene, candidates, load, near, category, half, self.unknown)),
            "target_category": np.array([category], np.int64),
            "target_half": half[None].astype(np.float32),
            "coming": coming_vector(coming, self.unknown)[None],
            "whole": np.array([whole], np.float32),
        }
        score, weight, mean, sigma = self._run(inputs, *CHOSEN)
        return SupportChoice(candidates, score - np.logaddexp.reduce(score), weight, mean, sigma)

    def _near(self, scene: ObservedScene) -> NDArray[np.float32]:
        """How near things of each category are to each object, (K, C + 1)."""
        return Proximity.of(scene).by_kind(scene, np.ones(len(scene.category), bool), self.unknown)

    def log_density(self, query: Query, support: int, place: Floats) -> float:
        """Log-density of position and heading of a place (4,) given its height on a support, nats (metres, radians).

        Of the mean over :data:`CODES` latent codes, with the critic's ratio over its mean in :data:`NORM` draws.
        """
        surface = query.scene.surface_of(float(place[2]), support) if support >= 0 else -1
        inputs = self._inputs(query, float(place[2]), (support, surface), NOTHING_ELSE)
        if not inputs["box"].shape[1]:
            return float("nan")
        rng, found = np.random.default_rng(0), []
        for _ in range(CODES if self.model.contract.latent else 1):
            mixture = self._mixture(inputs, rng)
            drawn = draw_places(inputs["box"][0], mixture, NORM, rng)[0]
            own, *ratios = self._ratios(inputs, mixture[-1], np.concatenate([place[None, [0, 1, 3]], drawn]))
            mean = np.logaddexp.reduce(ratios) - np.log(len(ratios))
            found.append(log_density(inputs, mixture, place) + own - mean)
        return float(np.logaddexp.reduce(found) - np.log(len(found)))

    def density_on(
        self, query: Query, points: Floats, bottom: float, candidate: tuple[int, int], rng: np.random.Generator
    ) -> tuple[Floats, Floats]:
        """The mixture's density with the critic's ratio; see :class:`~.proposer.Proposer`."""
        inputs = self._inputs(query, bottom, candidate, NOTHING_ELSE)
        if not inputs["box"].shape[1]:
            return np.zeros(len(points)), np.zeros(len(points))
        density, yaw = [], []
        for _ in range(SEEN if self.model.contract.latent else 1):
            mixture = self._mixture(inputs, rng)
            at, turn = position_density(inputs, mixture, points)
            density.append(at + self._ratios(inputs, mixture[-1], np.column_stack([points, turn])))
            yaw.append(turn)
        best = np.argmax(density, axis=0)
        mean = np.logaddexp.reduce(density, axis=0) - np.log(len(density))
        return mean, np.array(yaw)[best, np.arange(len(points))]

    def _inputs(self, query: Query, bottom: float, candidate: tuple[int, int], row: Upcoming) -> Arrays:
        scene, half, category, (support, surface) = query.scene, query.placeable.half, query.category, candidate
        seen = np.ones(len(scene.category), bool)
        tokens = tokens_for(scene, seen, support, surface, bottom, half)
        plan = plan_vector(scene, seen, category, support, surface, half, row.counts, row.area, row.whole)
        return {
            **_batch(context_arrays(scene, tokens, category, support, surface, self.unknown)),
            "target_category": np.array([category], np.int64),
            "target_half": half[None].astype(np.float32),
            "target_bottom": np.array([bottom - scene.room.ground], np.float32),
            "plan": plan[None],
            "row": coming_vector(row.counts, self.unknown)[None],
            "mask": np.ones((1, len(tokens)), np.float32),
        }

    def _mixture(self, inputs: Arrays, rng: np.random.Generator) -> list[Floats]:
        """The mixture (:data:`PLACED`) for one latent code; places behind walls have next to no weight."""
        code = rng.standard_normal((1, self.model.contract.latent)).astype(np.float32)
        weight, mean, *rest = self._run({**inputs, "latent": code}, *PLACED)
        behind = behind_walls(inputs["box"][0], inputs["flags"][0], mean, float(inputs["target_half"][0, :2].min()))
        kept = weight + np.where(behind, OUT, 0.0)
        return [kept - np.logaddexp.reduce(kept), mean, *rest]

    def propose_on(
        self, query: Query, count: int, rng: np.random.Generator, candidate: tuple[int, int], row: Upcoming,
        choice: SupportChoice | None = None,
    ) -> Proposals:  # fmt: skip
        """``count`` proposals on one candidate (object, surface); object -1 is the ground.

        More are drawn from the mixture; of these, those are kept that are drawn by the critic's ratios (without putting
        back, by Gumbel noise), and by what makes more or less variety of both densities.
        """
        scene, support = query.scene, candidate[0]
        bottoms = self._bottoms(scene, candidate, count, rng, choice)
        inputs = self._inputs(query, float(np.median(bottoms)), candidate, row)
        if not inputs["box"].shape[1]:
            return Proposals(np.full(count, support), _around_origin(bottoms, rng))
        mixture = self._mixture(inputs, rng)
        floor = support >= 0 and scene.support[support] < 0
        usual = MANY if floor or (support >= 0 and scene.room.inner[support]) else DRAWN
        drawn = max(query.sampling.candidates, count) if query.sampling.candidates else max(usual, count + DRAWN // 2)
        places, axis, kappa = draw_places(inputs["box"][0], mixture, drawn, rng)
        worth, power = self._ratios(inputs, mixture[-1], places), query.sampling.power
        if power != 1:  # drawn by one density, and wanted by a power of both
            worth = power * worth + (power - 1) * position_density(inputs, mixture, places[:, :2])[0]
        kept = np.argsort(-(worth + rng.gumbel(size=len(worth))))[:count]
        yaw = snapped(places[kept, 2], axis[kept], kappa[kept], SLACK if floor else 0.0)
        return Proposals(np.full(count, support), np.column_stack([places[kept, :2], bottoms, yaw]))

    def _ratios(self, inputs: Arrays, view: Floats, places: Floats) -> Floats:
        """What the critic says (T,) of places (T, 3): log ratios of densities, true ones to the mixture's."""
        asked = {"view": view.astype(np.float32)[None], "place": places.astype(np.float32)[None]}
        return self._run({**inputs, **asked}, "ratio")[0]

    def _bottoms(
        self, scene: ObservedScene, candidate: tuple[int, int], count: int, rng: np.random.Generator,
        choice: SupportChoice | None,
    ) -> Floats:  # fmt: skip
        """Heights (T,) of the target's bottom on a candidate: the surface's, or drawn where it hangs or leans."""
        support, surface = candidate
        if support < 0:
            return np.full(count, scene.room.ground)
        above = float(scene.center[support, 2] - scene.half[support, 2])
        if surface >= 0:
            return np.full(count, above + scene.surfaces(support)[surface, 0])
        if choice is None:
            return np.full(count, above)
        number = int(choice.candidates.at(np.array([support]), np.array([surface]))[0])
        chance = np.exp(choice.weight[number])
        part = rng.choice(len(chance), size=count, p=chance / chance.sum())
        return above + rng.normal(choice.mean[number, part], choice.sigma[number, part])

    def _run(self, inputs: Mapping[str, Any], *outputs: str) -> list[Floats]:
        return [part[0].astype(np.float64) for part in self.model.run(list(outputs), **inputs)]


def _batch(arrays: Arrays) -> dict[str, Any]:
    return {name: array[None] for name, array in arrays.items()}


def _around_origin(bottoms: Floats, rng: np.random.Generator) -> Floats:
    """Places in an empty world, for which there is nothing to go by."""
    places = np.zeros((len(bottoms), 4))
    places[:, :2] = rng.normal(0, 1, (len(bottoms), 2))
    places[:, 2], places[:, 3] = bottoms, rng.uniform(-np.pi, np.pi, len(bottoms))
    return places

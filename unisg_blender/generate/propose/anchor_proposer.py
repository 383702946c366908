"""Places proposed by the anchor mixture and its critic: support first, then height, then position and heading."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..observe.observed_scene import ObservedScene
from ..observe.placeable import Placeable
from ..observe.scene_tokens import Arrays, coming_vector, context_arrays, plan_vector, room_of, tokens_for
from ..observe.support_candidates import Proximity, SupportCandidates, SupportOccupancy, support_arrays
from .mixture import OUT, behind_walls, draw_places, log_density, snapped
from .proposer import Proposals
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

PLACED = ("weight", "mean", "sigma", "heading", "kappa", "seen")
CHOSEN = ("support_score", "height_weight", "height_mean", "height_sigma")


@dataclass(frozen=True, eq=False)
class Upcoming:
    """What else is to come to the same support: counts by category number, and their footprints in m2.

    ``whole`` says that the support was empty and this is all that it will hold, put there in the order of
    :mod:`..observe.placement_order`.
    The next in a row then goes beside the last, and how far depends on all that is to come;
    otherwise it could fill any gap, and more may come another time.
    """

    counts: Mapping[int, int]
    area: float
    whole: bool = False


@dataclass(frozen=True, eq=False)
class SupportChoice:
    """The candidates for one target: object, surface and log probability (N,), and the mixtures (N, L) of heights."""

    candidates: SupportCandidates
    score: NDArray[np.float64]
    weight: NDArray[np.float64]
    mean: NDArray[np.float64]
    sigma: NDArray[np.float64]


class AnchorProposer:
    """Draws from the model's densities with numpy."""

    def __init__(self, model: TrainedModel) -> None:
        self.model = model
        self.unknown = len(model.contract.vocabulary)

    def propose(
        self,
        scene: ObservedScene,
        category: int,
        placeable: Placeable,
        count: int,
        rng: np.random.Generator,
        allowed: NDArray[np.bool_],
        coming: Mapping[int, int],
    ) -> Proposals:
        """``count`` proposals for a new object; see :class:`~.proposer.Proposer`."""
        if not allowed.any():
            return self.propose_on(scene, category, placeable, count, rng, (-1, -1), Upcoming(coming, 0.0))
        load = SupportOccupancy.of(scene, np.ones(len(scene.category), bool))
        choice = self.choose(scene, load, category, placeable.half, allowed, coming)
        chance = np.exp(choice.score)
        drawn = rng.choice(len(chance), size=min(MOST_CANDIDATES, count), p=chance / chance.sum())
        supports, places = np.zeros(count, np.int64), np.zeros((count, 4))
        for number in np.unique(drawn):
            mine = np.resize(drawn, count) == number
            candidate = int(choice.candidates.obj[number]), int(choice.candidates.surface[number])
            found = self.propose_on(
                scene, category, placeable, int(mine.sum()), rng, candidate, Upcoming({}, 0.0), choice
            )
            supports[mine], places[mine] = candidate[0], found.places
        return Proposals(supports, places)

    def choose(
        self, scene: ObservedScene, load: SupportOccupancy, category: int, half: NDArray[np.float64],
        allowed: NDArray[np.bool_], coming: Mapping[int, int], whole: bool = False,
    ) -> SupportChoice:  # fmt: skip
        """Log probabilities of all candidates of the ``allowed`` objects, bool (K,), of which there is at least one.

        ``whole``: all of them were empty, and ``coming`` is all that will be put on them.
        """
        candidates = SupportCandidates.of(scene, np.flatnonzero(allowed))
        near = Proximity.of(scene).by_kind(scene, np.ones(len(allowed), bool), self.unknown)
        inputs = {
            **_batch(support_arrays(scene, candidates, load, near, category, half, self.unknown)),
            "target_category": np.array([category], np.int64),
            "target_half": half[None].astype(np.float32),
            "coming": coming_vector(coming, self.unknown)[None],
            "whole": np.array([whole], np.float32),
        }
        score, weight, mean, sigma = self._run(inputs, *CHOSEN)
        return SupportChoice(candidates, score - np.logaddexp.reduce(score), weight, mean, sigma)

    def support_chances(
        self, scene: ObservedScene, category: int, half: NDArray[np.float64], allowed: NDArray[np.bool_]
    ) -> NDArray[np.float64]:
        """The chance (K,) of each ``allowed`` object to hold a target: with what they hold already, nothing to come."""
        found = np.zeros(len(scene.category))
        if allowed.any():
            load = SupportOccupancy.of(scene, np.ones(len(scene.category), bool))
            choice = self.choose(scene, load, category, half, allowed, {})
            np.add.at(found, choice.candidates.obj, np.exp(choice.score))
        return found

    def log_density(
        self, scene: ObservedScene, category: int, placeable: Placeable, support: int, place: NDArray[np.float64]
    ) -> float:
        """Log-density of position and heading of a place (4,) given its height on a support, nats (metres, radians).

        Of the mean over :data:`CODES` latent codes, with the critic's ratio over its mean in :data:`NORM` draws.
        """
        surface = scene.surface_of(float(place[2]), support) if support >= 0 else -1
        inputs = self._inputs(scene, category, placeable.half, float(place[2]), (support, surface), Upcoming({}, 0.0))
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

    def density(
        self, scene: ObservedScene, category: int, half: NDArray[np.float64], bottom: float,
        candidate: tuple[int, int], row: Upcoming,
        rng: np.random.Generator,
    ) -> tuple[Arrays, list[NDArray[np.float64]]]:  # fmt: skip
        """The network's inputs and the mixture (:data:`PLACED`) over places on a candidate at a height, metres."""
        inputs = self._inputs(scene, category, half, bottom, candidate, row)
        return inputs, self._mixture(inputs, rng) if inputs["box"].shape[1] else []

    def _inputs(
        self,
        scene: ObservedScene,
        category: int,
        half: NDArray[np.float64],
        bottom: float,
        candidate: tuple[int, int],
        row: Upcoming,
    ) -> Arrays:
        support, surface = candidate
        seen = np.ones(len(scene.category), bool)
        tokens = tokens_for(scene, seen, support, surface, bottom, half)
        plan = plan_vector(scene, seen, category, support, surface, half, row.counts, row.area, row.whole)
        return {
            **_batch(context_arrays(scene, tokens, category, support, surface, self.unknown)),
            "target_category": np.array([category], np.int64),
            "target_half": half[None].astype(np.float32),
            "target_bottom": np.array([bottom - room_of(scene).ground], np.float32),
            "plan": plan[None],
            "row": coming_vector(row.counts, self.unknown)[None],
            "mask": np.ones((1, len(tokens)), np.float32),
        }

    def _mixture(self, inputs: Arrays, rng: np.random.Generator) -> list[NDArray[np.float64]]:
        """The mixture for one latent code; places behind walls have next to no weight."""
        code = rng.standard_normal((1, self.model.contract.latent)).astype(np.float32)
        weight, mean, *rest = self._run({**inputs, "latent": code}, *PLACED)
        behind = behind_walls(inputs["box"][0], inputs["flags"][0], mean, float(inputs["target_half"][0, :2].min()))
        kept = weight + np.where(behind, OUT, 0.0)
        return [kept - np.logaddexp.reduce(kept), mean, *rest]

    def propose_on(
        self, scene: ObservedScene, category: int, placeable: Placeable, count: int, rng: np.random.Generator,
        candidate: tuple[int, int], row: Upcoming, choice: SupportChoice | None = None,
    ) -> Proposals:  # fmt: skip
        """``count`` proposals on one candidate (object, surface); object -1 is the ground.

        More are drawn from the mixture; of these, those are kept that are drawn by the critic's ratios (without putting
        back, by Gumbel noise).
        """
        support = candidate[0]
        bottoms = self._bottoms(scene, candidate, count, rng, choice)
        inputs, mixture = self.density(scene, category, placeable.half, float(np.median(bottoms)), candidate, row, rng)
        if not mixture:
            return Proposals(np.full(count, support), _around_origin(bottoms, rng))
        floor = support >= 0 and scene.support[support] < 0
        drawn = MANY if floor or (support >= 0 and room_of(scene).inner[support]) else DRAWN
        places, axis, kappa = draw_places(inputs["box"][0], mixture, max(drawn, count + DRAWN // 2), rng)
        ratio = self._ratios(inputs, mixture[-1], places)
        kept = np.argsort(-(ratio + rng.gumbel(size=len(ratio))))[:count]
        yaw = snapped(places[kept, 2], axis[kept], kappa[kept], SLACK if floor else 0.0)
        return Proposals(np.full(count, support), np.column_stack([places[kept, :2], bottoms, yaw]))

    def _ratios(self, inputs: Arrays, view: NDArray[np.float64], places: NDArray[np.float64]) -> NDArray[np.float64]:
        """What the critic says (T,) of places (T, 3): log ratios of densities, true ones to the mixture's."""
        asked = {"view": view.astype(np.float32)[None], "place": places.astype(np.float32)[None]}
        return self._run({**inputs, **asked}, "ratio")[0]

    def _bottoms(
        self,
        scene: ObservedScene,
        candidate: tuple[int, int],
        count: int,
        rng: np.random.Generator,
        choice: SupportChoice | None,
    ) -> NDArray[np.float64]:
        """Heights (T,) of the target's bottom on a candidate: the surface's, or drawn where it hangs or leans."""
        support, surface = candidate
        if support < 0:
            return np.full(count, room_of(scene).ground)
        above = float(scene.center[support, 2] - scene.half[support, 2])
        if surface >= 0:
            return np.full(count, above + scene.surfaces(support)[surface, 0])
        if choice is None:
            return np.full(count, above)
        number = int(choice.candidates.at(np.array([support]), np.array([surface]))[0])
        chance = np.exp(choice.weight[number])
        part = rng.choice(len(chance), size=count, p=chance / chance.sum())
        return above + rng.normal(choice.mean[number, part], choice.sigma[number, part])

    def _run(self, inputs: Mapping[str, Any], *outputs: str) -> list[NDArray[np.float64]]:
        return [part[0].astype(np.float64) for part in self.model.run(list(outputs), **inputs)]


def _batch(arrays: Arrays) -> dict[str, Any]:
    return {name: array[None] for name, array in arrays.items()}


def _around_origin(bottoms: NDArray[np.float64], rng: np.random.Generator) -> NDArray[np.float64]:
    """Places in an empty world, for which there is nothing to go by."""
    places = np.zeros((len(bottoms), 4))
    places[:, :2] = rng.normal(0, 1, (len(bottoms), 2))
    places[:, 2], places[:, 3] = bottoms, rng.uniform(-np.pi, np.pi, len(bottoms))
    return places

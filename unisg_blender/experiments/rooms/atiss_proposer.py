"""Runs the set model of :mod:`...learn.atiss.network`, a baseline, as a proposer."""

from __future__ import annotations

import os

import numpy as np

from ...generate import Generator
from ...generate.observe.contract import KINDS
from ...generate.propose.proposer import Proposals, Proposer, Query
from ...generate.propose.trained_model import TrainedModel, load_model
from ...geometry.arrays import Floats
from .baselines import carrier_of

KIND = "atiss"
TOKENS = 256
"""Objects that the network looks at, at most: the first ones."""


def load_generator(path: str | os.PathLike[str]) -> Generator:
    """A generator from any model that can be measured: those of the library, and this baseline.

    Raises
    ------
    UniSGError
        If the file is missing or no model of either kind.
    """
    model = load_model(path, kinds=(*KINDS, KIND))
    return Generator(model, AtissProposer(model) if model.contract.kind == KIND else None)


class AtissProposer(Proposer):
    """Draws positions, then headings, from the network's mixtures of logistics; the carrier is found afterwards."""

    def __init__(self, model: TrainedModel) -> None:
        self.model = model
        self.unknown = len(model.contract.vocabulary)

    def propose(self, query: Query, count: int, rng: np.random.Generator) -> Proposals:
        """See :class:`~unisg_blender.generate.propose.proposer.Proposer`."""
        scene = query.scene
        origin = np.array([*scene.room.middle, scene.room.ground])
        position, _ = self._mixtures(query, np.zeros((1, 3)))
        drawn = np.column_stack([_draw(position[0, axis], count, rng) for axis in range(3)])
        _, heading = self._mixtures(query, drawn)
        turn = np.array([_draw(mixture, 1, rng)[0] for mixture in heading])
        places = np.column_stack([drawn + origin, turn])
        return Proposals(np.array([carrier_of(scene, place, query.allowed) for place in places], np.int64), places)

    def log_density(self, query: Query, support: int, place: Floats) -> float:
        """Of a position (x, y) and heading, whatever the support, nats (metres, radians)."""
        where = place[:3] - np.array([*query.scene.room.middle, query.scene.room.ground])
        position, heading = self._mixtures(query, where[None])
        around = place[3] + 2 * np.pi * np.arange(-1, 2)
        turn = np.logaddexp.reduce([_log_logistics(heading[0], value) for value in around])
        return float(sum(_log_logistics(position[0, axis], where[axis]) for axis in range(2)) + turn)

    def _mixtures(self, query: Query, places: Floats) -> tuple[Floats, Floats]:
        """Mixtures of position (T, 3, 3, M) and heading (T, 3, M) for the new object at each of places (T, 3)."""
        scene, count, seen = query.scene, len(places), slice(TOKENS)
        center = scene.center[seen] - np.array([*scene.room.middle, scene.room.ground])
        yaw, kind = scene.yaw[seen], scene.category[seen]
        box = np.column_stack([center, scene.half[seen], np.cos(yaw), np.sin(yaw)])
        kind = np.where(kind < 0, self.unknown, kind)
        position, heading = self.model.run(
            ["position", "heading"],
            category=kind[None].astype(np.int64),
            box=box[None].astype(np.float32),
            mask=np.ones((1, len(box)), np.float32),
            target_category=np.full((1, count), query.category, np.int64),
            target_half=np.tile(query.placeable.half, (1, count, 1)).astype(np.float32),
            place=places[None].astype(np.float32),
        )
        return position[0].astype(np.float64), heading[0].astype(np.float64)


def _draw(mixture: Floats, count: int, rng: np.random.Generator) -> Floats:
    """Values (count,) from one mixture (3, M) of logistics."""
    chance = np.exp(mixture[0] - mixture[0].max())
    part = rng.choice(len(chance), count, p=chance / chance.sum())
    return rng.logistic(mixture[1, part], mixture[2, part])


def _log_logistics(mixture: Floats, value: float) -> float:
    weight, mean, scale = mixture
    z = (value - mean) / scale
    return float(np.logaddexp.reduce(weight - z - np.log(scale) - 2 * np.logaddexp(0, -z)))

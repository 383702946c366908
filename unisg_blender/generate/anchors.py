"""Places proposed by the anchor mixture: support first, then height, then position and heading."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .context import Arrays, coming_vector, context_arrays, ground_of, plan_vector, support_arrays, tokens_for
from .model import Model
from .pieces import Piece
from .proposals import Proposals, Scene

COMPONENTS = 48
FIRST, MOST_SUPPORTS = 4, 3
"""Up to how many proposals are made for one support only, and on how many different ones at most."""


class AnchorProposer:
    """Draws from the model's densities with numpy."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.unknown = len(model.contract.vocabulary)

    def propose(
        self,
        scene: Scene,
        category: int,
        piece: Piece,
        count: int,
        rng: np.random.Generator,
        allowed: NDArray[np.bool_],
        coming: Mapping[int, int],
    ) -> Proposals:
        """``count`` proposals for a new thing; see :class:`~.proposals.Proposer`."""
        target: Arrays = {
            "target_category": np.array([category], np.int64),
            "target_half": piece.half[None].astype(np.float32),
            "coming": coming_vector(coming, self.unknown)[None],
        }
        supports, bottoms = self._supports(scene, target, category, count, rng, allowed)
        places = np.zeros((count, 4))
        for thing in np.unique(supports):
            mine = np.flatnonzero(supports == thing)
            places[mine] = self._places(scene, target, category, int(thing), bottoms[mine], rng, coming)
        return Proposals(supports, places)

    def _supports(
        self, scene: Scene, target: Arrays, category: int, count: int, rng: np.random.Generator,
        allowed: NDArray[np.bool_],
    ) -> tuple[NDArray[np.int64], NDArray[np.float64]]:  # fmt: skip
        """A support for each proposal (-1: the ground), at most :data:`MOST_SUPPORTS` different ones, and heights."""
        if not allowed.any():
            return np.full(count, -1, np.int64), np.full(count, ground_of(scene))
        things = np.arange(len(scene.category))
        inputs = _batch(support_arrays(scene, things, category, self.unknown)) | target | self._nothing(tokens=1)
        score, weight, mean, sigma = self._run(inputs, "support_score", "height_weight", "height_mean", "height_sigma")
        chance = np.exp(score - score[allowed].max()) * allowed
        drawn = rng.choice(len(chance), size=1 if count <= FIRST else MOST_SUPPORTS, p=chance / chance.sum())
        supports = np.resize(drawn, count)
        part = _pick(np.exp(weight[supports]), rng)
        each = np.arange(count)
        above = scene.center[supports, 2] - scene.half[supports, 2]
        return supports, above + rng.normal(mean[supports][each, part], sigma[supports][each, part])

    def _places(
        self, scene: Scene, target: Arrays, category: int, parent: int, bottoms: NDArray[np.float64],
        rng: np.random.Generator, coming: Mapping[int, int],
    ) -> NDArray[np.float64]:  # fmt: skip
        """Places (T, 4) on one support, at heights (T,), whose median the network is told."""
        visible = np.arange(len(scene.category))
        tokens = tokens_for(scene, visible, parent)
        if not len(tokens):
            return _around_origin(bottoms, rng)
        told = float(np.median(bottoms)) - ground_of(scene)
        inputs: dict[str, Any] = {
            **_batch(context_arrays(scene, tokens, category, parent, self.unknown)),
            **target,
            "target_bottom": np.array([told], np.float32),
            "plan": plan_vector(scene, visible, category, parent, coming)[None],
            "mask": np.ones((1, len(tokens)), np.float32),
        }
        inputs = self._nothing(supports=1) | inputs
        weight, mean, sigma, heading, kappa = self._run(inputs, "weight", "mean", "sigma", "heading", "kappa")
        part = _pick(np.tile(np.exp(weight), (len(bottoms), 1)), rng)
        box = inputs["box"][0, part // COMPONENTS].astype(np.float64)
        noise = rng.standard_normal((len(bottoms), 2)) * sigma[part]
        x = mean[part, 0] + box[:, 6] * noise[:, 0] - box[:, 7] * noise[:, 1]
        y = mean[part, 1] + box[:, 7] * noise[:, 0] + box[:, 6] * noise[:, 1]
        return np.stack([x, y, bottoms, rng.vonmises(_wrapped(heading[part]), kappa[part])], axis=1)

    def _run(self, inputs: Mapping[str, Any], *outputs: str) -> list[NDArray[np.float64]]:
        return [part[0].astype(np.float64) for part in self.model.run(list(outputs), **inputs)]

    def _nothing(self, tokens: int = 0, supports: int = 0) -> dict[str, Any]:
        """Blank inputs for the half of the network that is not asked."""
        blank: dict[str, Any] = {}
        if tokens:
            blank = {
                "target_bottom": np.zeros(1, np.float32), "plan": np.zeros((1, 5), np.float32),
                "category": np.zeros((1, tokens), np.int64), "box": np.ones((1, tokens, 8), np.float32),
                "flags": np.zeros((1, tokens, 6), np.float32), "mask": np.ones((1, tokens), np.float32),
            }  # fmt: skip
        if supports:
            blank |= {
                "support_category": np.zeros((1, supports), np.int64),
                "support_half": np.ones((1, supports, 3), np.float32),
                "support_load": np.zeros((1, supports, 4), np.float32),
            }
        return blank


def _batch(arrays: Arrays) -> dict[str, Any]:
    return {name: array[None] for name, array in arrays.items()}


def _pick(weights: NDArray[np.float64], rng: np.random.Generator) -> NDArray[np.int64]:
    """One column per row, at random by the weights (T, C)."""
    total = np.cumsum(weights, axis=1)
    return (total < rng.random((len(weights), 1)) * total[:, -1:]).sum(axis=1)


def _wrapped(angle: NDArray[np.float64]) -> NDArray[np.float64]:
    return (angle + np.pi) % (2 * np.pi) - np.pi


def _around_origin(bottoms: NDArray[np.float64], rng: np.random.Generator) -> NDArray[np.float64]:
    """Places in an empty world, for which there is nothing to go by."""
    places = np.zeros((len(bottoms), 4))
    places[:, :2] = rng.normal(0, 1, (len(bottoms), 2))
    places[:, 2], places[:, 3] = bottoms, rng.uniform(-np.pi, np.pi, len(bottoms))
    return places

"""Simple ways to place things, to compare a model with."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ..generate.pieces import Piece
from ..generate.proposals import Proposals, Scene

SPREAD_FLOOR = 0.005


class GaussianProposer:
    """One Gaussian per category and kind of support over the offset in the support's frame and the heading.

    The support is drawn by how often the category stands on things of its kind;
    the heading is normal around its circular mean. ``spread=0`` predicts the mean.

    Parameters
    ----------
    scenes
        Training scenes, categories numbered as in the model's vocabulary.
    spread
        Factor on the standard deviations.
    """

    def __init__(self, scenes: Sequence[Scene], spread: float = 1.0) -> None:
        found: dict[tuple[int, int], list[NDArray[np.float64]]] = defaultdict(list)
        for scene in scenes:
            kinds = np.append(scene.category, -2)[scene.support]
            for thing, offset in enumerate(offsets(scene)):
                if scene.category[thing] >= 0:
                    found[int(scene.category[thing]), int(kinds[thing])].append(offset)
        self.fits = {key: _fit(np.array(values)) for key, values in found.items()}
        self.counts = {key: len(values) for key, values in found.items()}
        self.spread = spread

    def propose(
        self, scene: Scene, category: int, piece: Piece, count: int, rng: np.random.Generator,
        allowed: NDArray[np.bool_], coming: Mapping[int, int],
    ) -> Proposals:  # fmt: skip
        """See :class:`~unisg_blender.generate.proposals.Proposer`."""
        if not allowed.any():
            return Proposals(np.full(count, -1, np.int64), rng.normal(0, 1, (count, 4)))
        things = np.flatnonzero(allowed)
        kinds = scene.category[things]
        same = np.array([(kinds == kind).sum() for kind in kinds])
        chance = np.array([self.counts.get((category, int(kind)), 0.1) for kind in kinds]) / same
        supports = things[rng.choice(len(things), count, p=chance / chance.sum())]
        places = np.zeros((count, 4))
        for row, thing in enumerate(supports):
            mean, deviation = self.fits.get((category, int(scene.category[thing])), _NOWHERE)
            offset = mean + self.spread * deviation * rng.standard_normal(4)
            cos, sin = np.cos(scene.yaw[thing]), np.sin(scene.yaw[thing])
            x, y = offset[:2]
            places[row] = (cos * x - sin * y, sin * x + cos * y, offset[2], offset[3])
            places[row] += (*scene.center[thing, :2], scene.center[thing, 2] - scene.half[thing, 2], scene.yaw[thing])
        return Proposals(supports.astype(np.int64), places)


_NOWHERE = (np.zeros(4), np.ones(4))


def offsets(scene: Scene) -> NDArray[np.float64]:
    """x, y, height of the bottom above the support's bottom, and heading (K, 4), in the frames of the supports."""
    held = scene.support >= 0
    support = np.maximum(scene.support, 0)
    offset = scene.center - np.where(held[:, None], scene.center[support], 0)
    yaw = np.where(held, scene.yaw[support], 0.0)
    below = np.where(held, scene.center[support, 2] - scene.half[support, 2], 0.0)
    cos, sin = np.cos(yaw), np.sin(yaw)
    x = cos * offset[:, 0] + sin * offset[:, 1]
    y = cos * offset[:, 1] - sin * offset[:, 0]
    return np.stack([x, y, scene.center[:, 2] - scene.half[:, 2] - below, scene.yaw - yaw], axis=1)


def _fit(values: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mean and standard deviation (4,); of the last column, angles, the circular ones."""
    resultant = np.exp(1j * values[:, 3]).mean()
    mean = np.append(values[:, :3].mean(axis=0), np.angle(resultant))
    turn = np.sqrt(-2 * np.log(np.clip(np.abs(resultant), 1e-6, 1)))
    return mean, np.append(np.maximum(values[:, :3].std(axis=0), SPREAD_FLOOR), max(turn, 0.01))


def nearest_scene(scene: Scene, training: Sequence[Scene], categories: int) -> int:
    """Number of the training scene whose counts of categories and room size are nearest."""
    wanted = _signature(scene, categories)
    return int(np.argmin([np.abs(_signature(other, categories) - wanted).sum() for other in training]))


def _signature(scene: Scene, categories: int) -> NDArray[np.float64]:
    counts = np.bincount(scene.category[scene.category >= 0], minlength=categories).astype(float)
    roots = np.flatnonzero(scene.support < 0)
    size = scene.half[roots, :2].max(axis=0, initial=0) if len(roots) else np.zeros(2)
    return np.append(counts, 4 * size)

"""The mixture over places that the network gives, in numpy: drawing from it, its density, and what walls cut off.

A mixture is a list of arrays, what :data:`.anchor_proposer.PLACED` names: log weights (N,), means (N, 2), spreads
(N, 2) along
the axes of the token that each component belongs to, headings (N,), concentrations (N,), and the view.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import i0e, ndtr, ndtri

from ...geometry.arrays import Bools, Floats
from ...geometry.planar import rotate_by, wrapped
from ..observe.scene_tokens import Arrays

COMPONENTS = 48
ALIGNED, SNAP = np.exp(8.0), np.radians(4)
"""A heading of at least this concentration within so many radians of its token's axes is meant to be along them."""

TAIL = 2.0
"""Positions are drawn within so many standard deviations: the tails of a normal distribution reach into others."""

FAINT = 9.0
"""Components of so much less log weight than the heaviest one do not show in a density."""

BEHIND, OUT = 1.5, -50.0
"""Places up to so many metres behind a wall are out of the room, and lose so much of their log weight."""


def draw_places(
    box: NDArray[np.float32], mixture: list[Floats], count: int, rng: np.random.Generator
) -> tuple[Floats, Floats, Floats]:
    """Places (T, 3) (x, y, yaw) from a mixture, the headings of their tokens and their concentrations (T,)."""
    weight, mean, sigma, heading, kappa, _ = mixture
    total = np.cumsum(np.exp(weight))
    part = np.searchsorted(total, rng.random(count) * total[-1]).clip(max=len(total) - 1)
    cos, sin = box[part // COMPONENTS, 6:].T.astype(np.float64)
    offset = ndtri(rng.uniform(ndtr(-TAIL), ndtr(TAIL), (count, 2))) * sigma[part]
    turn = rng.vonmises(wrapped(heading[part]), kappa[part])
    place = mean[part] + rotate_by(offset, cos, sin)
    axis = np.arctan2(sin.copy(), cos.copy())  # of strided columns it varies by the last bit
    return np.column_stack([place, turn]), axis, kappa[part]


def log_density(inputs: Arrays, mixture: list[Floats], place: Floats) -> float:
    """Log-density of a place (4,) in a mixture."""
    weight, mean, sigma, heading, kappa, _ = mixture
    cos, sin = np.repeat(inputs["box"][0, :, 6:], COMPONENTS, axis=0).T.astype(np.float64)
    seen = rotate_by(place[:2] - mean, cos, -sin) / sigma
    at = -0.5 * (seen**2).sum(axis=1) - np.log(sigma).sum(axis=1) - np.log(2 * np.pi)
    turned = kappa * (np.cos(place[3] - heading) - 1) - np.log(2 * np.pi * i0e(kappa))
    return float(np.logaddexp.reduce(weight + at + turned))


def position_density(inputs: Arrays, mixture: list[Floats], points: Floats) -> tuple[Floats, Floats]:
    """Log-densities (N,) of positions (N, 2) whatever the heading, per m2, and the likeliest headings there (N,)."""
    weight, mean, sigma, heading, kappa, _ = mixture
    box = inputs["box"][0, :, 6:].astype(np.float64)
    kept = np.flatnonzero(weight > weight.max() - FAINT)
    cos, sin = box[kept // COMPONENTS].T
    seen = rotate_by(points[:, None] - mean[kept], cos, -sin) / sigma[kept]
    at = weight[kept] - 0.5 * (seen**2).sum(axis=2) - np.log(sigma[kept]).sum(axis=1) - np.log(2 * np.pi)
    sharp = -np.log(2 * np.pi * i0e(kappa[kept]))
    best = (at + sharp).argmax(axis=1)
    axis = np.arctan2(sin, cos)
    return np.logaddexp.reduce(at, axis=1), snapped(heading[kept][best], axis[best], kappa[kept][best], 0.0)


def behind_walls(box: NDArray[np.float32], flags: NDArray[np.float32], mean: Floats, half: float) -> Bools:
    """Which places (N, 2) of an object lie behind one of the walls in view or deep in it, unless a wall holds it.

    ``half`` is its smaller half extent, metres, half of which may be in the wall.
    """
    walls = flags[:, 4] != 0
    if not walls.any() or (walls & (flags[:, 0] > 0)).any():
        return np.zeros(len(mean), bool)
    x, y, _, long, thick, _, cos, sin = box[walls].astype(np.float64).T
    along, into = np.moveaxis(rotate_by(mean[:, None] - np.stack([x, y], axis=1), cos, -sin), -1, 0)
    into = into * flags[walls, 4]
    return ((np.abs(along) < long) & (into < thick + half / 2) & (into > -BEHIND)).any(axis=1)


def snapped(yaw: Floats, axis: Floats, kappa: Floats, slack: float) -> Floats:
    """Headings (T,), turned towards the nearest quarter from ``axis`` where the model is sure and they are near it.

    A share ``slack`` of what they are off is left.
    """
    off = wrapped(4 * (yaw - axis)) / 4
    return yaw - (1 - slack) * np.where((kappa >= ALIGNED) & (np.abs(off) < SNAP), off, 0.0)

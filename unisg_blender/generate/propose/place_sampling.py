"""How places are drawn from what a model says: as it learned, nearer to the likeliest, or freer."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...errors import UniSGError
from ...geometry.arrays import Floats

LEAST = 0.01
"""Variety under which the likeliest of what was drawn is taken in any case."""

MOST_VARIETY, MOST_CANDIDATES = 100.0, 4096
"""Of either at most: a hundred draws as good as evenly, and so many candidates at a time are enough."""


@dataclass(frozen=True)
class Sampling:
    """How places are drawn.

    Attributes
    ----------
    variety
        Temperature: densities and probabilities are raised to the power of ``1 / variety``. 1 draws as the model
        learned, 0 takes the likeliest of what was drawn, more than 1 draws unlikely places more often.
    candidates
        How many places are drawn of which those to be tried are chosen; 0: as many as is usual for the model. The
        more, the nearer to what the model and the variety say.

    Raises
    ------
    UniSGError
        If one of them is out of range.
    """

    variety: float = 1.0
    candidates: int = 0

    def __post_init__(self) -> None:
        if not 0 <= self.variety <= MOST_VARIETY:  # false for nan, too
            raise UniSGError(f"the variety must be a number from 0 to {MOST_VARIETY:g}, not {self.variety!r}")
        if not 0 <= self.candidates <= MOST_CANDIDATES:
            raise UniSGError(f"the number of candidates must be from 0 to {MOST_CANDIDATES}, not {self.candidates!r}")

    @property
    def power(self) -> float:
        """To which a density is raised."""
        return 1.0 / max(self.variety, LEAST)

    def tempered(self, score: Floats) -> Floats:
        """Log probabilities (N,) of something to be chosen, raised to that power; they add up to 1 again."""
        if self.variety == 1:
            return score
        return np.asarray(self.power * score - np.logaddexp.reduce(self.power * score))


USUAL = Sampling()

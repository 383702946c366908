"""What passes between a model and the generator: where new objects could be."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..observe.observed_scene import ObservedScene
from ..observe.placeable import Placeable


@dataclass(frozen=True, eq=False)
class Proposals:
    """T proposed places (T, 4) (x, y, bottom z, yaw) with the supports int64 (T,) that they are meant for.

    ``score`` (T,) is the logarithm of their density where the model has one.
    """

    support: NDArray[np.int64]
    places: NDArray[np.float64]
    score: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))


class Proposer(Protocol):
    """A model that proposes where a new object could be."""

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
        """``count`` proposals for a placeable of a category.

        ``allowed`` bool (K,) says which objects may hold it, ``coming`` how many objects of
        which categories are still to be placed after it.
        """

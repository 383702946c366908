"""What passes between a model and the generator: the scene as arrays, and proposed places."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from .pieces import Piece
from .things import Things


@dataclass(eq=False)
class Scene:
    """The things of a scene that is growing, K of them.

    Attributes
    ----------
    category, support
        int64 (K,): number in the model's vocabulary (-1 for others), and the thing that holds it (-1: none).
    world, local
        (K, 4, 4): matrices of the things' entities in the world, and relative to their supports.
    center, half, yaw
        (K, 3), (K, 3), (K,): the upright boxes, as in :class:`~.things.Things`.
    """

    category: NDArray[np.int64]
    support: NDArray[np.int64]
    world: NDArray[np.float64]
    local: NDArray[np.float64]
    center: NDArray[np.float64]
    half: NDArray[np.float64]
    yaw: NDArray[np.float64]

    @staticmethod
    def of(things: Things, world: NDArray[np.float64]) -> Scene:
        """The scene of some things whose entities have ``world`` (K, 4, 4) matrices."""
        local = relative(world, things.support)
        return Scene(things.category, things.support, world, local, things.center, things.half, things.yaw)

    def add(
        self, category: int, support: int, world: NDArray[np.float64], piece: Piece, place: NDArray[np.float64]
    ) -> int:
        """A further thing at a place (4,); returns its number."""
        above = self.world[support] if support >= 0 else np.eye(4)
        center = place[:3] + np.array([0, 0, piece.half[2]])
        self.category = np.append(self.category, category)
        self.support = np.append(self.support, support)
        self.local = np.concatenate([self.local, _solve(above, world)[None]])
        self.world = np.concatenate([self.world, world[None]])
        self.center = np.concatenate([self.center, center[None]])
        self.half = np.concatenate([self.half, piece.half[None]])
        self.yaw = np.append(self.yaw, place[3])
        return len(self.category) - 1


def relative(world: NDArray[np.float64], support: NDArray[np.int64]) -> NDArray[np.float64]:
    """Matrices (K, 4, 4) relative to those of the supports (int (K,), -1 for the world)."""
    local = world.copy()
    for thing in np.flatnonzero(support >= 0):
        local[thing] = _solve(world[support[thing]], world[thing])
    return local


def _solve(above: NDArray[np.float64], world: NDArray[np.float64]) -> NDArray[np.float64]:
    try:
        return np.linalg.solve(above, world)
    except np.linalg.LinAlgError:  # a support scaled to nothing: only where it is counts
        moved = world.copy()
        moved[:3, 3] -= above[:3, 3]
        return moved


@dataclass(frozen=True, eq=False)
class Proposals:
    """T proposed places (T, 4) (x, y, bottom z, yaw) with the supports int64 (T,) that they are meant for.

    ``score`` (T,) is the logarithm of their density where the model has one.
    """

    support: NDArray[np.int64]
    places: NDArray[np.float64]
    score: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))


class Proposer(Protocol):
    """A model that proposes where a new thing could be."""

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
        """``count`` proposals for a piece of a category.

        ``allowed`` bool (K,) says which things may hold it, ``coming`` how many things of
        which categories are still to be placed after it.
        """

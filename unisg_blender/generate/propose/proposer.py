"""What passes between a model and the generator: where new objects could be."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ...errors import UniSGError
from ...geometry.arrays import Bools, Floats, Ints
from ..observe.observed_scene import ObservedScene
from ..observe.placeable import Placeable
from ..observe.support_candidates import SupportCandidates, SupportOccupancy
from .place_sampling import USUAL, Sampling

DRAWN, KERNEL = 256, 0.15
"""Proposals of which a density is estimated, and the spread of each in metres."""


@dataclass(frozen=True, eq=False)
class Query:
    """What a model is asked about one new object.

    Attributes
    ----------
    scene
        What is there, K objects.
    category, placeable
        Number of the new object's category, and its shape.
    allowed
        bool (K,): which objects may hold it.
    coming
        How many objects of which categories are still to be placed after it.
    sampling
        How places are drawn; rules know no likelier places and leave it.
    """

    scene: ObservedScene
    category: int
    placeable: Placeable
    allowed: Bools
    coming: Mapping[int, int]
    sampling: Sampling = USUAL


@dataclass(frozen=True, eq=False)
class Proposals:
    """T proposed places (T, 4) (x, y, bottom z, yaw) with the supports int64 (T,) that they are meant for (-1: the
    ground)."""

    support: Ints
    places: Floats

    def __post_init__(self) -> None:
        if not np.isfinite(self.places).all():
            raise UniSGError("the model proposes places that are no finite numbers: it is damaged; give another model")


@dataclass(frozen=True, eq=False)
class Upcoming:
    """What else is to come to the same support: counts by category number, and their footprints in m2.

    ``whole`` says that the support was empty and this is all that it will hold, put there in the order of
    :mod:`..observe.placement_order`.
    The next in a row then goes beside the last, and how far depends on all that is to come;
    otherwise it could fill any gap, and more may come another time.
    """

    counts: Mapping[int, int]
    area: float = 0.0
    whole: bool = False


NOTHING_ELSE = Upcoming({})


@dataclass(frozen=True, eq=False)
class SupportChoice:
    """The candidates for one target: object, surface and log probability (N,), and the mixtures (N, L) of heights."""

    candidates: SupportCandidates
    score: Floats
    weight: Floats
    mean: Floats
    sigma: Floats


class Proposer(ABC):
    """A model that proposes where a new object could be.

    One that only proposes is asked object by object. One that also chooses among the candidates for a support can
    plan a room: what stands where is then decided level by level before places are proposed.
    """

    @abstractmethod
    def propose(self, query: Query, count: int, rng: np.random.Generator) -> Proposals:
        """``count`` proposals on any of the objects that may hold the new one; on the ground where none may."""

    def propose_on(
        self, query: Query, count: int, rng: np.random.Generator, candidate: tuple[int, int], row: Upcoming,
        choice: SupportChoice | None = None,
    ) -> Proposals:  # fmt: skip
        """``count`` proposals on one candidate (object, surface); on any for a model that knows no candidates.

        ``choice`` is what :meth:`choose` said about it.
        """
        return self.propose(query, count, rng)

    def density_on(
        self, query: Query, points: Floats, bottom: float, candidate: tuple[int, int], rng: np.random.Generator
    ) -> tuple[Floats, Floats]:
        """How likely positions on one candidate (object, surface) are, and how the new object would be turned there.

        Of a model that only draws by a kernel estimate of what it draws.

        Parameters
        ----------
        points
            (N, 2), world metres.
        bottom
            Height of the new object's bottom, metres.

        Returns
        -------
        tuple
            Log-densities per m2 (N,), up to a constant, and turns (N,), radians.
        """
        alone = replace(query, allowed=np.arange(len(query.allowed)) == candidate[0])
        places = self.propose_on(alone, DRAWN, rng, candidate, NOTHING_ELSE).places
        away = ((points[:, None] - places[:, :2]) ** 2).sum(axis=2) / KERNEL**2
        density = np.logaddexp.reduce(-away / 2, axis=1) - np.log(DRAWN * 2 * np.pi * KERNEL**2)
        return density, places[away.argmin(axis=1), 3]

    def choose(self, query: Query, load: SupportOccupancy, whole: bool = False) -> SupportChoice | None:
        """Log probabilities of all candidates of the objects that may hold the new one, of which there is at least
        one; None from a model that makes no choice.

        ``whole``: all of them were empty, and what is coming is all that will be put on them.
        """
        return None

"""Places proposed by trees: many plain proposals, of which those are drawn that the trees take for true ones."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from ...geometry.arrays import Floats
from ..observe.seen_places import SeenPlaces
from .place_features import CategoryKinds, place_features
from .plain_proposals import PLAINEST, TriedRoom, plain_proposals
from .proposer import Proposals, Proposer, Query
from .trained_model import TrainedModel

MANY = 1500
"""Plain proposals that are judged at a time."""

SHARPNESS = 1.5
"""Exponent of the odds with which they are drawn: 1 would draw as the trees believe, more the likelier ones."""


class TreesProposer(Proposer):
    """Draws from plain proposals by what the trees of a model say; plain ones of a category where trees do not help.

    The contract says how often a place is drawn without asking the trees: what held-out rooms have shown to be best.
    """

    def __init__(self, model: TrainedModel) -> None:
        self.model = model
        contract = model.contract
        self.places = SeenPlaces.from_record(contract.places, contract.vocabulary)
        self._last: tuple[Query, Proposals, Floats] | None = None

    @cached_property
    def kinds(self) -> CategoryKinds:
        """What the features say of categories."""
        contract = self.model.contract
        return CategoryKinds.of(contract.tables, contract.priors.sizes, contract.vocabulary)

    def propose(self, query: Query, count: int, rng: np.random.Generator) -> Proposals:
        """See :class:`~.proposer.Proposer`."""
        contract = self.model.contract
        name = contract.vocabulary[query.category]
        plain = rng.random(count) < contract.plain.get(name, 0.0)
        found = self.bootstrapped(query, count, rng)
        if plain.all():
            return found
        judged = self.drawn(query, count, rng, query.sampling.power * contract.sharpness.get(name, SHARPNESS))
        places = np.where(plain[:, None], found.places, judged.places)
        return Proposals(np.where(plain, found.support, judged.support), places)

    def bootstrapped(self, query: Query, count: int, rng: np.random.Generator) -> Proposals:
        """Seen places at the same fraction of a support of the same kind: what the trees are measured against."""
        room, seen = TriedRoom.of(query.scene, self.model.contract.tables), self.places.of_category(query.category)
        return plain_proposals(room, seen, query.placeable.half, query.allowed, count, rng, PLAINEST)

    def drawn(self, query: Query, count: int, rng: np.random.Generator, sharpness: float) -> Proposals:
        """``count`` of the judged places, drawn without putting back by their odds to the power of ``sharpness``."""
        judged, score = self._judged(query, rng)
        best = np.argsort(-(sharpness * score + rng.gumbel(size=len(score))))[:count]
        return Proposals(judged.support[best], judged.places[best])

    def _judged(self, query: Query, rng: np.random.Generator) -> tuple[Proposals, Floats]:
        """Plain proposals and the log odds (T,) that they are true; the same for the same query."""
        if self._last is None or self._last[0] is not query:
            room = TriedRoom.of(query.scene, self.model.contract.tables)
            half, seen = query.placeable.half, self.places.of_category(query.category)
            judged = plain_proposals(room, seen, half, query.allowed, query.sampling.candidates or MANY, rng)
            features = place_features(room, self.kinds, query.category, half, judged)
            score = self.model.run(["score"], features=features)[0].reshape(-1).astype(np.float64)
            self._last = query, judged, score
        return self._last[1:]

"""How foreign a scene is to what a network has learned from: by where its embedding lies, and by its categories."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError
from ..runtime.json_records import from_record
from ..scene.graph import SceneGraph
from ..spatial.object_rows import object_rows

SLACK = 2.0
"""How many times as far as held-out scenes of its kind a scene may lie from what was learned from."""

FEWEST_KNOWN = 0.5
"""Share of objects of known categories, of the least that a scene learned from had, that a scene must have."""

MOST_KEPT = 60
DIGITS = 4


@dataclass(frozen=True)
class FamiliarRecord:
    """A :class:`Familiarity` in a model's metadata."""

    embeddings: tuple[tuple[float, ...], ...]
    reach: float
    categories: tuple[str, ...]
    share: float


@dataclass(frozen=True, eq=False)
class Familiarity:
    """What scenes of one kind are like, of which a network has learned.

    Attributes
    ----------
    embeddings
        float32 (K, D): some of them, as the network embeds them.
    reach
        The largest distance of a held-out one to the nearest of these.
    categories
        Of all their objects.
    share
        The least share of objects with a category that one of them has.
    """

    embeddings: NDArray[np.float32]
    reach: float
    categories: frozenset[str]
    share: float

    @staticmethod
    def learned(
        seen: NDArray[np.float32], held_out: NDArray[np.float32], categories: Collection[str], shares: Sequence[float]
    ) -> Familiarity:
        """From the embeddings of scenes learned from, (K, D), and of held-out ones, (H, D)."""
        kept = seen[:MOST_KEPT]
        return Familiarity(kept, float(_nearest(held_out, kept).max()), frozenset(categories), min(shares))

    @staticmethod
    def from_record(found: Any) -> Familiarity:
        """What :meth:`to_record` wrote; UniSGError if it is damaged."""
        record = from_record(FamiliarRecord, found, "what the model knows of a kind of scenes")
        if len({len(row) for row in record.embeddings}) != 1:
            raise UniSGError("the embeddings of the model's scenes differ in width: train it again")
        embeddings = np.array(record.embeddings, np.float32)
        return Familiarity(embeddings, record.reach, frozenset(record.categories), record.share)

    def to_record(self) -> dict[str, Any]:
        """JSON-ready."""
        return {
            "embeddings": [[round(value, DIGITS) for value in row] for row in self.embeddings.tolist()],
            "reach": round(self.reach, DIGITS),
            "categories": sorted(self.categories),
            "share": round(self.share, DIGITS),
        }

    def distance(self, embedding: NDArray[np.float32]) -> float:
        """How many times as far as a held-out scene at most a scene, (D,), lies from the nearest one learned from."""
        return float(_nearest(embedding[None], self.embeddings)[0]) / max(self.reach, 1e-9)

    def is_foreign(self, distance: float, known: int, categorised: int, objects: int) -> bool:
        """Whether a scene is none of this kind; the categories of one without any say nothing."""
        unknown = categorised > 0 and known < FEWEST_KNOWN * self.share * objects
        return distance > SLACK or unknown


def _nearest(points: NDArray[np.float32], others: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.linalg.norm(points[:, None] - others[None], axis=2).min(axis=1)


def object_categories(graph: SceneGraph) -> list[str]:
    """The category of each object of a scene, "" for none."""
    found = object_rows(graph)
    return [graph.category_name(int(row)) for row in np.unique(found[found >= 0])]

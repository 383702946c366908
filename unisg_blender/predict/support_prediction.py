"""Which object stands on which, by a trained network over pairs of objects near each other."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError
from ..geometry.arrays import Ints
from ..geometry.boxes import Boxes
from ..runtime.json_records import from_record
from ..scene.graph import SceneGraph
from ..spatial import find_objects
from ..spatial.relations import with_relations
from .object_pairs import PAIR_CHANNELS, candidate_pairs, in_chunks, pair_features
from .prediction_session import load_network

KIND = "on_top_of"
Found = tuple[int, str, int, float]
"""Row of the subject, kind, row of the target, chance."""


@dataclass(frozen=True)
class TopologyRecord:
    """What is read of the model's metadata."""

    channels: tuple[str, ...]
    threshold: float
    extra: dict[str, Any] = field(default_factory=dict)


class TopologyModel:
    """The network over pairs, from an ONNX file; the shipped one when ``path`` is omitted."""

    def __init__(self, path: str | os.PathLike[str] | None = None) -> None:
        self.network = load_network("topology", path)
        record = from_record(TopologyRecord, self.network.metadata, f"{self.network.path}: its metadata")
        if record.channels != PAIR_CHANNELS:
            raise UniSGError(f"{self.network.path} was trained on other features: train it again")
        self.threshold = record.threshold
        """The chance from which on a pair is told, chosen on validation scenes."""

    def chances(self, boxes: Boxes, pairs: Ints) -> NDArray[np.float32]:
        """For each pair (P, 2) of boxes the chance (P,) that the first stands on the second."""
        parts = [self.network.run(features=pair_features(boxes, some))[0] for some in in_chunks(pairs)]
        logits = np.concatenate([np.zeros(0, np.float32), *parts])
        return (1 / (1 + np.exp(-logits.clip(-40, 40)))).astype(np.float32)

    def find(self, graph: SceneGraph, threshold: float | None = None) -> list[Found]:
        """Relations of a scene: row of the subject, "on_top_of", row of the target, and the chance; sorted by rows."""
        objects = find_objects(graph, empty=False)
        rows, boxes = objects.rows, objects.oriented
        pairs = candidate_pairs(boxes)
        chance = self.chances(boxes, pairs)
        kept = chance >= (self.threshold if threshold is None else threshold)
        found = zip(rows[pairs[kept]].tolist(), chance[kept].tolist(), strict=True)
        return sorted((subject, KIND, target, round(value, 4)) for (subject, target), value in found)


def with_supports(graph: SceneGraph, found: Iterable[Found]) -> SceneGraph:
    """The scene with these relations for the ones of the kind "on_top_of" that it had; all others stay."""
    return with_relations(graph, [entry[:3] for entry in found], [KIND])

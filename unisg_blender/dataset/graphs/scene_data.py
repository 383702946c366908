"""Graphs that know what their numbers mean, and that refuse to be batched with graphs that mean something else."""

from __future__ import annotations

from typing import Any, NoReturn

from torch_geometric.data import HeteroData

from ...errors import UniSGError
from ..format.schema import VOCABULARIES
from .vocabularies import NumberedNames


class Numbering(dict[NumberedNames, int]):
    """The vocabulary of a graph as its only key: PyG looks the first graph's key up in every graph of a batch."""

    def __missing__(self, other: NumberedNames) -> NoReturn:
        (own,) = self
        kinds = [kind for kind, names, others in zip(VOCABULARIES, own, other, strict=True) if names != others]
        raise UniSGError(
            f"graphs that number their {' and '.join(kinds)} differently cannot be one batch: make all of them with "
            "to_heterodata(graph, vocabulary=common_vocabulary(graphs)), or with the vocabulary of one dataset"
        )


class SceneData(HeteroData):
    """A scene, or (as the class of a ``Batch``) some scenes, with the names that their numbers stand for."""

    numbering: Any

    @property
    def vocabulary(self) -> dict[str, tuple[str, ...]]:
        """The names by number: "categories", "relations", "scenes"."""
        (names,) = self.numbering
        return dict(names._asdict())

"""Which number stands for which name: one vocabulary for several scenes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from ...scene import SceneGraph
from ...scene.components import RELATIONS
from ...spatial.relations import KINDS
from ...spatial.supports import SUPPORT_KINDS
from ..format.schema import VOCABULARIES

RELATION_KINDS = tuple(dict.fromkeys((*KINDS, *SUPPORT_KINDS)))
"""The kinds of relations that every graph has edges for, be they none."""


class NumberedNames(NamedTuple):
    """A vocabulary as one value: equal where all numbers mean the same."""

    categories: tuple[str, ...]
    relations: tuple[str, ...]
    scenes: tuple[str, ...]

    def __str__(self) -> str:
        return ", ".join(f"{len(names)} {kind}" for kind, names in zip(VOCABULARIES, self, strict=True))


def as_names(vocabulary: Mapping[str, Sequence[str]]) -> NumberedNames:
    """The value of a vocabulary; a list that it lacks is empty."""
    return NumberedNames(*(tuple(vocabulary.get(kind, ())) for kind in VOCABULARIES))


def common_vocabulary(graphs: Iterable[SceneGraph]) -> dict[str, tuple[str, ...]]:
    """A vocabulary for all of some scenes: ``to_heterodata(graph, vocabulary=...)`` numbers their names alike.

    Categories are sorted; of relations the known kinds come first, so that graphs of
    other scenes have edges of the same types.
    """
    categories: set[str] = set()
    relations: set[str] = set()
    for graph in graphs:
        categories.update(graph.vocabulary)
        relations.update(kind for _, kind in graph.entries(RELATIONS, "kind"))
    more = sorted(relations.difference(RELATION_KINDS))
    return {"categories": tuple(sorted(categories)), "relations": (*RELATION_KINDS, *more), "scenes": ()}

"""What an object's name says about its category."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np

from ..geometry.arrays import Floats

_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[^\W\d_A-Z]+")
FUZZY = 0.6
"""Share of common letter triples from which two words count as forms of one word."""

MEANINGLESS = frozenset(
    ("mesh", "object", "obj", "geo", "geometry", "node", "group", "default", "low", "high", "poly", "model", "lod",
     "part", "small", "big", "large", "medium", "left", "right", "cube", "plane", "sphere", "cylinder", "cone", "torus",
     "circle", "suzanne", "the", "of", "with", "and", "new", "copy")
)  # fmt: skip
"""Words that stand in names of all kinds of objects; the shapes are the names that modelling software gives."""


def words(name: str) -> list[str]:
    """Lower-case words of a name: "BarStool_02.001" gives bar, stool; words that say nothing are left out."""
    found = (word.casefold() for word in _WORD.findall(name))
    return [word for word in found if len(word) > 1 and word not in MEANINGLESS]


def name_scores(name: str, lexicon: Sequence[Mapping[str, float]]) -> Floats:
    """How well a name fits each category, float64 (K,) in 0..1; all 0 if no word is known.

    Parameters
    ----------
    name
        Name of an object or a mesh.
    lexicon
        For each category its words, with a weight in 0..1 each.

    Notes
    -----
    A word fits a category by its best match there; forms of one word ("chairs")
    are found by their letter triples. The last known word counts three times: in
    "desk lamp" it is the lamp. Scores are shares of the known words' weight.
    """
    scores, total = np.zeros(len(lexicon)), 0.0
    for position, word in enumerate(reversed(words(name))):
        matches = np.array([_match(word, known) for known in lexicon])
        if not matches.any():
            continue
        importance = 3.0 if total == 0 else 1.0
        scores += importance * matches
        total += importance
        if position > 6:
            break
    return scores / total if total else scores


def _match(word: str, known: Mapping[str, float]) -> float:
    if word in known:
        return known[word]
    triples = _triples(word)
    return max((weight * share for other, weight in known.items() if (share := _alike(triples, other)) >= FUZZY),
               default=0.0)  # fmt: skip


def _triples(word: str) -> frozenset[str]:
    padded = f" {word} "
    return frozenset(padded[k : k + 3] for k in range(len(padded) - 2))


def _alike(triples: frozenset[str], other: str) -> float:
    others = _triples(other)
    return 2 * len(triples & others) / (len(triples) + len(others))

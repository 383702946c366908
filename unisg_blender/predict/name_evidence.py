"""What an object's name says about its category."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import Floats
from ..words import VocabularyMatch
from ..words.split_names import telling_words
from ..words.vocabulary_match import BROAD, MAPPED, SAME, WORD

FUZZY = 0.6
"""Share of common letter triples from which two words count as forms of one word."""

BY_TABLE = 1.5
"""How much a word of the table of words says, where a full match of the lexicon says 1."""

words = telling_words
"""The words of a name that say something."""


@dataclass(frozen=True, eq=False)
class NameEvidence:
    """What names say of a thing: how well each category fits, ``scores`` (K,) from 0 on, or which ``thing`` it is that
    the vocabulary lacks, "" for none."""

    scores: Floats
    thing: str = ""


def name_evidence(names: Sequence[str], match: VocabularyMatch, lexicon: Sequence[Mapping[str, float]]) -> NameEvidence:
    """What the names of a thing and its mesh say in a vocabulary.

    A word of the table of words counts first: it means one category, or any of those that it is the broader term of. A
    thing that the vocabulary lacks, such as a nightstand, stays what it is. Else the first name with a word of the
    lexicon counts, see :func:`name_scores`. Parts are named after their thing and say nothing. What the user says of a
    word counts before all of it.
    """
    places = {name: place for place, name in enumerate(match.own.values())}
    nothing = np.zeros(len(places))
    for name in names:
        found = match.match(name)
        if found.how == MAPPED:
            return NameEvidence(nothing, found.category)
        if found.part:
            return NameEvidence(nothing)
        if found.how in (SAME, WORD, BROAD):
            scores = nothing.copy()
            scores[[places[category] for category in (found.category, *found.others)]] = BY_TABLE
            return NameEvidence(scores)
        if found.thing:
            return NameEvidence(nothing, found.thing)
    for name in names:
        if (scores := name_scores(name, lexicon)).any():
            return NameEvidence(scores)
    return NameEvidence(nothing)


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

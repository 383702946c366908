"""From a word to a category of a vocabulary, and how sure that is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import Floats
from .split_names import name_words, singular_forms, telling_words
from .word_table import WordTable, thing_table

SAME, WORD, KIND, BROAD, MAPPED = "same", "word", "kind", "broad", "mapped"
"""How a word was understood: it is the category's name; another word for it; something that is a kind of it; a broader
term of which it is one; or the user said so."""


@dataclass(frozen=True)
class WordMatch:
    """What a word means in a vocabulary: ``category`` ("" for nothing), ``how`` it was understood, the ``thing`` that
    it is by itself, whether only a ``part`` of it, and what ``else`` it might have meant."""

    category: str = ""
    how: str = ""
    thing: str = ""
    part: bool = False
    others: tuple[str, ...] = ()


class VocabularyMatch:
    """Words in the vocabulary of a model.

    Parameters
    ----------
    vocabulary
        The categories.
    said
        What the user says of words: word to category, "" for none of them; it counts before everything else.
    sizes
        Usual extents of categories (3,), metres, by which a broader term is told.
    """

    def __init__(
        self, vocabulary: Sequence[str], said: Mapping[str, str] | None = None,
        sizes: Mapping[str, Sequence[float]] | None = None, table: WordTable | None = None,
    ) -> None:  # fmt: skip
        self.table, self.sizes = table or thing_table(), sizes or {}
        self.own = {_key(name): name for name in vocabulary}
        self.said = {_key(word): category for word, category in (said or {}).items()}
        self.of_thing: dict[str, str] = {}
        for name in vocabulary:
            if thing := name if name in self.table.things else self.table.look_up(_key(name)):
                best = self.of_thing.get(thing)
                self.of_thing[thing] = name if best is None or name == thing else best

    def match(self, text: str, size: Floats | None = None) -> WordMatch:
        """What a name or a category means; ``size`` (3,) metres of the thing, where it is known."""
        reading = self.table.read(text)
        for mine, how in ((self.said, MAPPED), (self.own, SAME)):
            for key in _keys(text, reading.thing if how == MAPPED and not reading.part else ""):
                if key in mine:
                    return WordMatch(mine[key], how, mine[key])
        if reading.part or not reading.thing:
            return WordMatch(thing=reading.thing, part=reading.part)
        return self._of_thing(reading.thing, size)

    def _of_thing(self, thing: str, size: Floats | None) -> WordMatch:
        if thing in self.of_thing:
            return WordMatch(self.of_thing[thing], WORD, thing)
        options = [self.of_thing[name] for name in self.table.narrower(thing) if name in self.of_thing]
        if options:
            best = self._nearest(options, size)
            return WordMatch(best, BROAD, thing, others=tuple(name for name in options if name != best))
        for name in self.table.things[thing].broader:
            if name in self.of_thing:
                return WordMatch(self.of_thing[name], KIND, thing)
        return WordMatch(thing=thing)

    def _nearest(self, options: Sequence[str], size: Floats | None) -> str:
        """Of several categories the one whose usual size is nearest, the first where no size is known."""
        known = [name for name in options if name in self.sizes and min(self.sizes[name]) > 0]
        if size is None or not known or min(size) <= 0:
            return options[0]
        return min(known, key=lambda name: float(np.abs(_measures(size) - _measures(np.array(self.sizes[name]))).sum()))


def _measures(size: Floats) -> Floats:
    """Logarithms of the longer and the shorter side, and of the height."""
    return np.asarray(np.log([size[:2].max(), size[:2].min(), size[2]]))


def _key(text: str) -> str:
    return "".join(name_words(text)) or text.casefold()


def _keys(text: str, thing: str) -> list[str]:
    """How a text may stand in a list of words: as it is, in the singular, without what says nothing, as its thing."""
    found = [form for key in (_key(text), "".join(telling_words(text))) if key for form in singular_forms(key)]
    return [*found, _key(thing)] if thing else found

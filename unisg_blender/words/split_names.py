"""The words of a name, and what in it says nothing: numbers, prefixes, levels of detail."""

from __future__ import annotations

import re
import unicodedata

_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[^\W\d_A-Z]+")
_ACCENT = re.compile("[\u0300-\u036f]")

MEANINGLESS = frozenset(
    ("mesh", "object", "obj", "geo", "geometry", "node", "group", "default", "low", "high", "poly", "model", "lod",
     "part", "small", "big", "large", "medium", "left", "right", "cube", "plane", "sphere", "cylinder", "cone", "torus",
     "circle", "suzanne", "the", "new", "copy", "sm", "sk", "prop", "props", "asset", "visual", "grp", "instance",
     "aws", "vray", "max", "final", "old", "composite", "lowpoly", "highpoly")
)  # fmt: skip
"""Words that stand in names of all kinds of objects; the shapes are the names that modelling software gives."""


def plain(text: str) -> str:
    """A text without case and accents, to be compared: "Canapé" is "canape", "Stühle" is "stuhle"."""
    return _bare(text).casefold()


def name_words(name: str) -> list[str]:
    """The plain words of a name, as :func:`plain` has them, with those that say nothing.

    "SM_BarStool_02a.001" gives sm, bar, stool, a.
    """
    return [word.casefold() for word in _WORD.findall(_bare(name))]


def _bare(text: str) -> str:
    """A text without accents; Japanese voice marks are no accents."""
    return unicodedata.normalize("NFC", _ACCENT.sub("", unicodedata.normalize("NFKD", text)))


def telling_words(name: str) -> list[str]:
    """The words of a name that say something: "SM_BarStool_02a.001" gives bar, stool."""
    return [word for word in name_words(name) if word not in MEANINGLESS and (len(word) > 1 or not word.isascii())]


def singular_forms(word: str) -> tuple[str, ...]:
    """A word and what it may be the plural of: "couches" may be that of "couche" or "couch"."""
    found = [word]
    if len(word) > 3 and word.endswith("s") and not word.endswith("ss"):
        found.append(word[:-1])
        if word.endswith("es"):
            found.append(word[:-2])
        if word.endswith("ies"):
            found.append(word[:-3] + "y")
    return tuple(found)

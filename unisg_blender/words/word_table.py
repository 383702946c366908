"""The table of things and their words in several languages, and what thing a name speaks of."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

from ..errors import UniSGError
from ..runtime.atomic_files import read_plain
from .split_names import name_words, plain, singular_forms, telling_words

FILE = Path(__file__).with_name("things.toml")

BROADER, SIZE, PLACE = "is", "size", "place"
"""Entries of a thing that are no languages."""

PLACES = ("wall", "floor", "top")
"""Where things stand: at a wall, on the floor, on top of furniture."""

MOST_WORDS = 5
"""Words of a name that are read as one, at most: "table de salle a manger"."""

SHORTEST_HEAD, SHORTEST_REST = 4, 3
"""Letters of the last part of a compound, and of what stands before it, at least: "kitchen|stuhl", not "car|pet"."""

PARTS = frozenset(
    ("leg", "legs", "top", "back", "backrest", "armrest", "arm", "handle", "handles", "knob", "drawer", "drawers",
     "base", "foot", "feet", "wheel", "shade", "bulb", "lid", "frame", "seat", "hinge", "panel", "screen",
     "cover", "body", "stand", "post", "jamb", "sill", "edge", "cushion", "cushions", "shelf",
     "shelves", "burner", "basin", "collision", "collider", "mattress", "display", "pot", "plate", "board",
     "sponge", "roll", "bat", "brush", "hanger", "holder", "dispenser", "opener", "shaker", "racket", "goal", "cloth",
     "rail", "bracket", "mount", "middle", "leaves", "leaf", "foliage", "cord", "cable", "pipe", "door", "doors",
     "pillow", "pillows", "bein", "beine", "platte", "griff", "fuss", "lehne", "schublade")
)  # fmt: skip
"""Words that, behind a thing, name a part of it or another thing: "Chair_Leg", "Cabinet_Door", "DishSponge"."""

COUNTS = frozenset(("one", "two", "three", "four", "six", "double", "triple", "single"))
"""Words behind which a part only describes: "cabinet two door"."""

MATERIALS = frozenset(("glass", "metal", "fabric", "wood", "wooden", "leather", "marble", "paper"))
"""Words that, beside another thing, only describe it."""

BUILDING = ("Floor", "Wall", "Ceiling", "Column")
"""Things that, behind others, only say where these are: "cabinet wall"."""

AFTER_HEAD = frozenset(("of", "de", "del", "di", "da", "du", "des", "with", "mit", "avec", "con", "and", "for", "para",
                        "fur", "von", "aus", "und", "et", "y", "e", "w", "in", "on"))  # fmt: skip
"""Words before which the thing itself is named: "bottle of wine", "silla de madera"."""

SPELT = {"ä": "ae", "ö": "oe", "ü": "ue", "Ä": "Ae", "Ö": "Oe", "Ü": "Ue"}

NOT_THINGS = frozenset(
    ("eyeglasses", "sunglasses", "hourglass", "wallpaper", "sandpaper", "flashlight", "dashboard", "toiletpaper",
     "papertowel", "keychain", "doorbell", "ucx", "ubx", "usp", "collider", "wireframe", "windowsill", "headphone",
     "headphones", "xylophone", "furnitures", "footprint", "fingerprint", "blueprint", "vegetable", "vegetables",
     "portable", "transplant", "doorway", "microphone", "saxophone", "megaphone", "forklift", "cupcake", "ashtray",
     "steckdose")
)  # fmt: skip
"""Compounds whose last part is a thing that they are not."""


@dataclass(frozen=True)
class Thing:
    """A kind of things: its name, the broader terms it falls under, nearest first, and its words by language; usual
    ``size`` (3,) in metres, () where there is none, and where it usually stands, one of :data:`PLACES` or ""."""

    name: str
    broader: tuple[str, ...]
    words: Mapping[str, tuple[str, ...]]
    size: tuple[float, ...] = ()
    place: str = ""


@dataclass(frozen=True)
class NameReading:
    """What a name speaks of: a ``thing`` of the table, "" for none, and whether it is only a ``part`` of it."""

    thing: str
    part: bool = False


@dataclass(frozen=True, eq=False)
class WordTable:
    """Things by name, in the order of the file."""

    things: Mapping[str, Thing]

    @cached_property
    def index(self) -> dict[str, str]:
        """The thing that each phrase means, by its plain words without spaces."""
        found: dict[str, str] = {}
        for thing in self.things.values():
            for phrase in (thing.name, *(word for words in thing.words.values() for word in words)):
                for form in _forms(phrase):
                    found.setdefault(form, thing.name)
        return {form: name for form, name in found.items() if form not in COUNTS}

    def narrower(self, name: str) -> list[str]:
        """The things that fall under a broader term, in the table's order."""
        return [thing.name for thing in self.things.values() if name in thing.broader]

    def look_up(self, phrase: str) -> str:
        """The thing of a phrase without spaces, or of its singular; "" if there is none."""
        return next((self.index[form] for form in singular_forms(phrase) if form in self.index), "")

    def read(self, name: str) -> NameReading:
        """What a name speaks of.

        The last thing in it counts, as in "desk lamp"; what stands behind a preposition describes it only. A part
        that is named behind its thing makes a part.
        """
        words = telling_words(name)
        if not NOT_THINGS.isdisjoint(words) or "".join(words) in NOT_THINGS:
            return NameReading("")
        found, place = "", 0
        part = False
        while place < len(words):
            if found and words[place] in AFTER_HEAD:
                break
            thing, used = self._longest(words, place)
            if found and used <= 1 and words[place] in PARTS and not self._is_head(words, place):
                part = part or words[place - 1] not in COUNTS
            elif thing and not (found and self._describes(thing, words[place], found)):
                found, part = thing, False
            place += max(used, 1)
        return NameReading(found, part)

    def _describes(self, thing: str, word: str, found: str) -> bool:
        """Whether a word behind a thing only describes it: "cabinet wall", "table glass", "sofa 2 seats"."""
        return thing in BUILDING or word in MATERIALS or thing in self.things[found].broader

    def _is_head(self, words: list[str], place: int) -> bool:
        """Is a word that may name a part followed by a thing?"""
        return any(
            self._longest(words, later)[0] and words[later] not in PARTS for later in range(place + 1, len(words))
        )

    def _longest(self, words: list[str], place: int) -> tuple[str, int]:
        """The thing that the most words from a place on mean, and how many these are."""
        for count in range(min(MOST_WORDS, len(words) - place), 0, -1):
            if thing := self.look_up("".join(words[place : place + count])):
                return thing, count
        return self._of_compound(words[place]), 1

    def _of_compound(self, word: str) -> str:
        """The thing that the end of one long word means: "kuchenstuhl", "木椅"; "" if there is none."""
        if word in NOT_THINGS:
            return ""
        if not word.isascii() and any(ord(letter) > 0x2E80 for letter in word):
            ends = (word[start:end] for end in range(len(word), 0, -1) for start in range(end))
            return next((self.index[part] for part in ends if part in self.index), "")
        for start in range(SHORTEST_REST, len(word) - SHORTEST_HEAD + 1):
            if thing := self.look_up(word[start:]):
                return thing
        return ""


def _forms(phrase: str) -> tuple[str, ...]:
    """How a phrase may be written: without spaces, and with ae, oe, ue for umlauts."""
    spelt = "".join(SPELT.get(letter, letter) for letter in phrase)
    return tuple(dict.fromkeys("".join(name_words(text)) or plain(text) for text in (phrase, spelt)))


@cache
def thing_table() -> WordTable:
    """The table that comes with the library."""
    return read_table(FILE)


def read_table(path: Path) -> WordTable:
    """Read a table of things, TOML: ``[Name] is = [broader terms]``, and words by language with commas between them.

    Raises
    ------
    UniSGError
        If the file cannot be read, is no TOML, or has another form.
    """
    try:
        content = tomllib.loads(read_plain(path).decode("utf-8"))
    except OSError as error:
        raise UniSGError(f"cannot read the table of words {path}: {error.strerror}") from None
    except ValueError as error:
        raise UniSGError(f"the table of words {path} is not valid TOML: {error}") from None
    things = {}
    for name, entry in content.items():
        if not isinstance(entry, dict):
            raise UniSGError(f"{path}: {name!r} must be a table of languages")
        words = {language: text for language, text in entry.items() if language not in (BROADER, SIZE, PLACE)}
        if not all(isinstance(text, str) for text in words.values()):
            raise UniSGError(f"{path}: the words of {name!r} must be text with commas between them")
        listed = {language: tuple(word.strip() for word in text.split(",")) for language, text in words.items()}
        size, place = tuple(map(float, entry.get(SIZE, ()))), entry.get(PLACE, "")
        things[name] = Thing(name, tuple(entry.get(BROADER, ())), listed, size, place)
    return WordTable(things)

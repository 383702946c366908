"""What kind of room it is, by the things in it, or by a name."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from functools import cache
from pathlib import Path

from .split_names import name_words
from .word_table import WordTable, read_table

FILE = Path(__file__).with_name("rooms.toml")

TELLING = {
    "kitchen": ("Cooker", "Refrigerator", "Sink", "Counter", "Dishwasher", "Microwave", "Range Hood", "Toaster",
                "Kettle", "Coffee Machine", "Pan", "Cooking Pot"),
    "bedroom": ("Bed", "Nightstand", "Wardrobe", "Mattress", "Dresser", "Blanket"),
    "bathroom": ("Toilet", "Bathtub", "Shower", "Sink", "Towel", "Towelrack", "Faucet"),
    "living room": ("Sofa", "Television", "Television Stand", "Coffee Table", "Armchair", "Bookshelf", "Fireplace",
                    "Remote"),
    "dining room": ("Dining Table", "Chair", "Plate", "Fork"),
    "office": ("Desk", "Office Chair", "Computer", "Monitor", "Keyboard", "Printer", "Whiteboard"),
    "operating room": ("Operating Table", "Surgical Lamp", "Anaesthesia Machine", "Mayo Stand", "Instrument Table",
                       "IV Pole", "Scalpel", "Forceps", "Syringe", "Patient"),
    "hospital room": ("Hospital Bed", "IV Pole", "Wheelchair"),
}  # fmt: skip
"""The things that tell each kind."""

CERTAIN = frozenset(("Bed", "Toilet", "Bathtub", "Cooker", "Refrigerator", "Sofa", "Operating Table", "Hospital Bed"))
"""Things of which one is enough."""

LOUNGING = frozenset(("Sofa",))
"""Of these there is one in other rooms too: alone it makes no living room of a part of them."""


def room_kind(things: Iterable[str]) -> str:
    """The kind of room that has these things (names of the table of words), "" where they do not say."""
    return next(iter(told_by(things)), "")


def told_by(things: Iterable[str]) -> dict[str, tuple[str, ...]]:
    """The kinds of room that has these things, each with those of them that tell it: the most likely first.

    The others share the room, as in an open plan. Nothing where the things do not say which is the first.
    """
    there = set(things)
    votes = Counter({kind: sum(name in there for name in telling) for kind, telling in TELLING.items()})
    (kind, most), (_, second) = votes.most_common(2)
    sure = most >= 2 or not CERTAIN.isdisjoint(there & set(TELLING[kind]))
    if most <= second or not sure:
        return {}
    telling = {name: tuple(thing for thing in TELLING[name] if thing in there) for name, _ in votes.most_common()}
    shared = {
        name
        for name, found in telling.items()
        if not CERTAIN.isdisjoint(found) and (len(found) >= 2 or not LOUNGING.issuperset(found))
    }
    return {name: things for name, things in telling.items() if name == kind or name in shared}


def kind_in_name(name: str) -> str:
    """The kind of room that a name speaks of, in any of the table's languages: "Kitchen Floor", "Küche_01"; else ""."""
    return room_table().read(name).thing


def said_kind(text: str) -> str:
    """A kind of room as a user says it: that of the table, "the kitchen" for kitchen; else the plain words."""
    return kind_in_name(text) or " ".join(word for word in name_words(text) if word not in ARTICLES)


@cache
def room_table() -> WordTable:
    """The words for kinds of rooms that come with the library."""
    return read_table(FILE)


ARTICLES = frozenset(("the", "a", "an"))

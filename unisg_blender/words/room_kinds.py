"""What kind of room it is, by the things in it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

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


def room_kind(things: Iterable[str]) -> str:
    """The kind of room that has these things (names of the table of words), "" where they do not say."""
    there = set(things)
    votes = Counter({kind: sum(name in there for name in telling) for kind, telling in TELLING.items()})
    (kind, most), (_, second) = votes.most_common(2)
    sure = most >= 2 or not CERTAIN.isdisjoint(there & set(TELLING[kind]))
    return kind if most > second and sure else ""

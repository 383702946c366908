"""How many objects of which categories are wanted, as people write it."""

from __future__ import annotations

import re

from ..errors import UniSGError

MOST_OBJECTS = 100_000
"""Objects that are added in one call, at most: at milliseconds each, more would take hours, and are a slip."""

COUNT = re.compile(r"^\d+\s|[:*]\s*\d+$|\sx?\s*\d+$")
"""A number that stands before or behind a name without a "="."""


def parse_counts(text: str) -> dict[str, int]:
    """Categories and numbers out of "Scalpel=2,Monitor" (1 where no number stands).

    Raises
    ------
    UniSGError
        If the text is not of that form, or more than :data:`MOST_OBJECTS` objects are wanted.
    """
    counts: dict[str, int] = {}
    for part in text.split(","):
        name, equals, number = (word.strip() for word in part.partition("="))
        if not name or (equals and not number.isdecimal()) or (not equals and COUNT.search(name)):
            raise UniSGError(f'what to add must look like "Scalpel=2,Monitor=1", not {text[:100]!r}')
        many = len(number) > len(str(MOST_OBJECTS))
        counts[name] = counts.get(name, 0) + (MOST_OBJECTS + 1 if many else int(number or 1))
    if sum(counts.values()) > MOST_OBJECTS:
        raise UniSGError(
            f"at most {MOST_OBJECTS} objects can be added at a time: ask for fewer, and for more of them later"
        )
    return counts

"""How many objects of which categories are wanted, as people write it."""

from __future__ import annotations

from ..errors import UniSGError


def parse_counts(text: str) -> dict[str, int]:
    """Categories and numbers out of "Scalpel=2,Monitor" (1 where no number stands).

    Raises
    ------
    UniSGError
        If the text is not of that form.
    """
    counts: dict[str, int] = {}
    for part in text.split(","):
        name, equals, number = (word.strip() for word in part.partition("="))
        if not name or (equals and not number.isdecimal()):
            raise UniSGError(f'what to add must look like "Scalpel=2,Monitor=1", not {text!r}')
        counts[name] = counts.get(name, 0) + int(number or 1)
    return counts

"""Few words for much: lists cut short, and notes about many things grouped by what they say."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

NAMES = 3
DETAILS = 6


def some_of(words: Iterable[str], most: int = NAMES) -> str:
    """The first words, and how many more there are: "a, b, c and 12 more"."""
    listed = list(words)
    hidden = len(listed) - most
    return ", ".join(listed[:most]) + (f" and {hidden} more" if hidden > 0 else "")


def first_lines(lines: Sequence[str], limit: int, rest: str) -> list[str]:
    """At most ``limit`` lines (0: all), then how many ``rest`` ("more relations: --limit 0 ...") are not shown."""
    hidden = len(lines) - limit if limit else 0
    return [*lines[:limit], f"... and {hidden} {rest}"] if hidden > 0 else list(lines)


def grouped(notes: Iterable[tuple[str, str]], named: bool = True) -> list[str]:
    """One line for each kind of note, however many things have it.

    Parameters
    ----------
    notes
        Pairs of a thing's name ("" for none) and what is said of it. What stands before the first colon
        is the kind, behind it come details: "settings that are not read: Color, Display As".
    named
        Whether a line names things that have it, or only says how many they are.
    """
    kinds: dict[str, tuple[dict[str, None], dict[str, None]]] = {}
    for name, text in notes:
        kind, _, details = text.partition(": ")
        names, found = kinds.setdefault(kind, ({}, {}))
        names.update({name: None} if name else {})
        found.update(dict.fromkeys(details.split(", ")) if details else {})
    return [_line(kind, list(names), list(details), named) for kind, (names, details) in kinds.items()]


def _line(kind: str, names: list[str], details: list[str], named: bool) -> str:
    text = f"{kind}: {some_of(details, DETAILS)}" if details else kind
    if len(names) > 1:
        return f"{text} ({len(names)} objects: {some_of(names)})" if named else f"{text} ({len(names)} objects)"
    return f"{names[0]}: {text}" if names and named else text

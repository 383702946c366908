"""What could not be represented, object by object: never dropped in silence."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from .wording import grouped, some_of


class Loss(UserWarning):
    """A warning that some objects lose something; its message names the first of them."""

    def __init__(self, text: str, names: Iterable[str]) -> None:
        self.text, self.names = text, tuple(names)
        super().__init__(f"{text}: {some_of(self.names)}")


@dataclass
class ReadReport:
    """Collects (object name, what was lost or changed); "" stands for the file as a whole."""

    entries: list[tuple[str, str]] = field(default_factory=list)

    def add(self, name: str, text: str) -> None:
        """Note one loss; the same note is kept once."""
        if (name, text) not in self._seen:
            self._seen.add((name, text))
            self.entries.append((name, text))

    def extend(self, other: ReadReport) -> None:
        """Take over the notes of another report."""
        for name, text in other.entries:
            self.add(name, text)

    _seen: set[tuple[str, str]] = field(default_factory=set, repr=False)

    def __len__(self) -> int:
        return len(self.entries)

    def __iter__(self) -> Iterator[str]:
        return (f"{name}: {text}" if name else text for name, text in self.entries)

    def lines(self) -> list[str]:
        """One line for each kind of loss, with the first objects that have it."""
        return grouped(self.entries)

    def summary(self, most: int | None = None) -> str:
        """One line: what was lost, and for how many objects; "" if nothing was. ``most`` limits the kinds of loss."""
        kinds = grouped(self.entries, named=False)
        hidden = 0 if most is None else max(0, len(kinds) - most)
        return "; ".join([*kinds[:most], *([f"and {hidden} more kinds of loss"] if hidden else [])])

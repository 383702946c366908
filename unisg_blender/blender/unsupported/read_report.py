"""What could not be represented, object by object: never dropped in silence."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field


@dataclass
class ReadReport:
    """Collects (object name, what was lost or changed); "" stands for the file as a whole."""

    entries: list[tuple[str, str]] = field(default_factory=list)

    def add(self, name: str, text: str) -> None:
        """Note one loss; the same note is kept once."""
        if (name, text) not in self._seen:
            self._seen.add((name, text))
            self.entries.append((name, text))

    _seen: set[tuple[str, str]] = field(default_factory=set, repr=False)

    def __len__(self) -> int:
        return len(self.entries)

    def __iter__(self) -> Iterator[str]:
        return (f"{name}: {text}" if name else text for name, text in self.entries)

    def summary(self) -> str:
        """One line: what was lost, and for how many objects; "" if nothing was."""
        counts: dict[str, int] = {}
        for _, text in self.entries:
            counts[text] = counts.get(text, 0) + 1
        parts = [text if count == 1 else f"{text} ({count} objects)" for text, count in counts.items()]
        return "; ".join(parts)

"""Telling how far the work is without telling it for every entity."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[int, int], None]
"""Told how many entities are done, of how many."""


def ticks(total: int, progress: Progress | None) -> Callable[[], None]:
    """A function to be called once per entity that tells ``progress`` a hundred times in all."""
    done = 0

    def tick() -> None:
        """Count one, and tell it a hundred times in all."""
        nonlocal done
        done += 1
        if progress is not None and (done == total or done % max(1, total // 100) == 0):
            progress(done, total)

    return tick

"""In which order things are placed: what holds others first, then large before small."""

from __future__ import annotations

from collections.abc import Mapping

from .habits import Habits


def levels(habits: Habits) -> dict[str, int]:
    """How many supports are usually under each category."""
    usual = {name: found[0].support for name, found in habits.supports.items() if found}
    level: dict[str, int] = {}
    for name in usual:
        below, seen = name, {name}
        while (below := usual.get(below, "")) and below not in seen:
            seen.add(below)
        level[name] = len(seen) - 1
    return level


def in_order(counts: Mapping[str, int], habits: Habits) -> list[str]:
    """One entry per object asked for, in the order of placing."""
    level = levels(habits)

    def key(name: str) -> tuple[int, float, str]:
        width, depth, _ = habits.sizes.get(name, (0.0, 0.0, 0.0))
        return level.get(name, 0), -width * depth, name

    return [name for name in sorted(counts, key=key) for _ in range(int(counts[name]))]

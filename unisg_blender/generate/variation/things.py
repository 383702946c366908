"""The things of a scene that may vary: what names mean, and what stands on what."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase

import numpy as np

from ...scene import SceneGraph
from ...scene.categories import STRUCTURE
from ...spatial.objects import scene_objects
from ..observe.scene_reading import SceneReading


@dataclass(frozen=True, eq=False)
class Things:
    """The things of a scene that are no building.

    Attributes
    ----------
    rows
        Rows of their entities, ascending.
    category
        Of each row its category in a model's words, "" for none.
    names
        Of each row what it may be called: its categories, its name and its uid, in small letters.
    above
        Of each row the rows of what stands on it, or hangs from it.
    """

    rows: tuple[int, ...]
    category: Mapping[int, str]
    names: Mapping[int, tuple[str, ...]]
    above: Mapping[int, tuple[int, ...]]

    @staticmethod
    def of(reading: SceneReading) -> Things:
        """Those of a scene as a model reads it."""
        graph, own = reading.graph, reading.scene
        objects = scene_objects(graph, ())
        rows = [int(row) for row in objects.row.tolist() if _is_thing(graph, int(row))]
        above: dict[int, list[int]] = {}
        for number, support in enumerate(objects.support.tolist()):
            if support >= 0:
                above.setdefault(int(objects.row[support]), []).append(int(objects.row[number]))
        category = {row: graph.category_name(row) for row in rows}
        said = {row: (category[row], own.category_name(row), own.name[row], own.uid[row]) for row in rows}
        names = {row: tuple(name.casefold() for name in found) for row, found in said.items()}
        return Things(tuple(rows), category, names, {row: tuple(found) for row, found in above.items()})

    def chosen(self, chances: Mapping[str, float], rng: np.random.Generator) -> list[int]:
        """Rows of the things that names mean, each with the chance that its name has."""
        drawn = zip(self.rows, rng.random(len(self.rows)).tolist(), strict=True)
        return [row for row, number in drawn if number < self._chance(row, chances)]

    def named(self, names: Iterable[str]) -> set[int]:
        """Rows of the things that names mean."""
        chances = dict.fromkeys(names, 1.0)
        return {row for row in self.rows if self._chance(row, chances)}

    def _chance(self, row: int, chances: Mapping[str, float]) -> float:
        """The chance of a thing: that of the first name that means it."""
        for pattern, chance in chances.items():
            if any(fnmatchcase(name, pattern.casefold()) for name in self.names[row] if name):
                return chance
        return 0.0

    def with_load(self, row: int) -> list[int]:
        """A thing and all that stands on it, and on that."""
        found = [row]
        for each in found:
            found += [other for other in self.above.get(each, ()) if other not in found]
        return found

    def count(self, rows: Iterable[int]) -> Counter[str]:
        """How many of each category there are at some rows."""
        return Counter(self.category[row] for row in rows if self.category.get(row))


def _is_thing(graph: SceneGraph, row: int) -> bool:
    return bool(graph.category_name(row)) and graph.category_name(row) not in STRUCTURE

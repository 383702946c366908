"""Living rooms: a seating group before a television, a place to eat, books, plants and small objects."""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import Floats
from ..scene.graph import SceneGraph
from .furniture import building
from .home_lesson import home_lesson
from .layout import Layout, Placed, pick
from .living_groups import dining_group, television_group
from .living_walls import along_the_walls
from .shell import Opening, Side, build_shell, cut_corner, keep_door_free, rectangle

HEIGHT = 2.5
DOOR = (0.9, 2.05)


def living_room(seed: int) -> SceneGraph:
    """A living room, 3.5-6 x 3.5-7 m, rectangular, L-shaped or with a slanted corner.

    The same seed always gives the same room, bit for bit.

    Parameters
    ----------
    seed
        Any integer that is not negative; every one gives another room.
    """
    layout = furnish(seed)
    return layout.build(*home_lesson(layout))


def furnish(seed: int) -> Layout:
    """The room's objects, before they become a scenegraph."""
    rng = np.random.default_rng((seed, 2))
    layout = Layout(f"Living Room {seed}", rng, _outline(rng))
    floor, sides = _shell(layout)
    keep_door_free(layout, sides)
    television_group(layout, floor, sides)
    dining_group(layout, floor, sides)
    along_the_walls(layout, floor, sides)
    return layout


def _outline(rng: np.random.Generator) -> Floats:
    outline = rectangle(rng.integers(36, 61) / 10, rng.integers(38, 71) / 10)
    if rng.random() < 0.55 or np.ptp(outline, axis=0).min() < 4.2:
        return outline
    square = bool(rng.random() < 0.6)
    x, y = rng.integers(8, 15, 2) / 10
    return cut_corner(outline, int(rng.integers(4)), x, y if square else x, square)


def _shell(layout: Layout) -> tuple[Placed, list[Side]]:
    """A door in one wall, windows with curtains in one or two others."""
    rng = layout.rng
    lengths = np.linalg.norm(np.roll(layout.outline, -1, axis=0) - layout.outline, axis=1)
    order = rng.permutation(np.flatnonzero(lengths > 2.2))
    filling: dict[int, tuple[Opening, object]] = {}
    width, height = DOOR
    slack = lengths[order[0]] / 2 - width / 2 - 0.25
    x = round(float(pick(rng, [-1, 1]) * slack * rng.uniform(0.5, 1.0)), 1)
    filling[int(order[0])] = ((x, 0.0, width, height), building.house_door(width, height))
    for edge in order[1 : 1 + int(rng.integers(1, 3))]:
        wide = pick(rng, [1.2, 1.6]) if lengths[edge] > 2.8 else 1.0
        x = round(float(rng.uniform(-0.4, 0.4) * (lengths[edge] - wide - 1.0)), 1)
        filling[int(edge)] = ((x, 0.9, wide, 1.3), building.window(wide, 1.3))
    walls = pick(rng, ["plaster", "cream", "linen"])
    return build_shell(layout, HEIGHT, "parquet", walls, filling)  # type: ignore[arg-type]

"""What stands and hangs along the walls of a living room."""

from __future__ import annotations

import numpy as np

from .furniture import building, living, storage
from .furniture.building import WALL_THICKNESS
from .layout import Layout, Placed, pick
from .living_groups import TEXTILES, WOODS
from .shell import Side, against, mount

BOOKS = [
    (0.02, 0.15, 0.20, "red"), (0.02, 0.15, 0.20, "canvas"), (0.02, 0.15, 0.20, "cream"), (0.03, 0.15, 0.24, "blue"),
    (0.03, 0.15, 0.24, "leather"), (0.03, 0.19, 0.24, "green"), (0.03, 0.19, 0.28, "dark"),
    (0.045, 0.19, 0.24, "walnut"), (0.045, 0.19, 0.28, "blue"), (0.045, 0.19, 0.28, "red"),
]  # fmt: skip
"""Thickness, depth and height in metres, and colour."""


def along_the_walls(layout: Layout, floor: Placed, sides: list[Side]) -> None:
    """Curtains, bookshelves, a cabinet, plants in the corners, pictures and a clock."""
    rng = layout.rng
    _curtains(layout, sides)
    wood = pick(rng, WOODS)
    for _ in range(int(rng.integers(1, 3))):
        _bookshelf(layout, floor, sides, wood)
    if rng.random() < 0.6:
        shape = storage.cabinet(pick(rng, [0.8, 1.0]), pick(rng, [0.9, 1.8]), wood, False, wood)
        cabinet = layout.place(shape, lambda: against(layout, sides, shape), floor, tries=16)
        if cabinet is not None and shape.size[2] < 1.2:
            layout.place_on(living.vase(0.06, bool(rng.random() < 0.5)), cabinet, "top")
            layout.place_on(living.ornament(pick(rng, ["globe", "box", "figure"])), cabinet, "top", yaw=0.0)
    _plants(layout, floor)
    for _ in range(int(rng.integers(1, 4))):
        width, height = [(0.6, 0.5), (0.5, 0.7), (1.0, 0.7)][int(rng.integers(3))]
        frame = building.picture(width, height, pick(rng, ["canvas", "leaf", "terracotta", "wool_blue"]))
        mount(layout, sides, frame, round(1.55 - height / 2, 3))
    if rng.random() < 0.4:
        mount(layout, sides, building.wall_clock(0.14), 1.9)


def _curtains(layout: Layout, sides: list[Side]) -> None:
    """A pair beside every window, where nothing stands in the way."""
    color = pick(layout.rng, TEXTILES)
    shape = building.curtain(0.3, 2.2, color)
    for side in sides:
        for start, stop, sill in side.openings:
            if sill == 0:
                continue
            for x in (start - 0.2, stop + 0.2):
                pose = side.wall.pose_at(x, -WALL_THICKNESS / 2 - shape.size[1] / 2, 0.05, 0.0)
                if abs(x) + 0.2 < side.length / 2 and layout.fits(shape, pose[None], side.wall)[0]:
                    layout.add(shape, pose, side.wall, "hangs_from")


def _bookshelf(layout: Layout, floor: Placed, sides: list[Side], wood: str) -> None:
    """Upright books in runs, some lying, an ornament here and there."""
    rng = layout.rng
    shape = storage.shelf(pick(rng, [0.8, 1.0, 1.2]), pick(rng, [1.8, 2.0]), 0.3, 5, wood, "Bookshelf")
    shelf = layout.place(shape, lambda: against(layout, sides, shape, (0.005, 0.03)), floor, tries=16)
    if shelf is None:
        return
    for board, top in shape.surfaces.items():
        x = -top.size[0] / 2 + rng.uniform(0.0, 0.04)
        for _ in range(int(rng.integers(0, 9))):
            thick, depth, height, color = pick(rng, BOOKS)
            book = living.standing_book(thick, depth, height, color)
            if height < top.headroom and x + thick < top.size[0] / 2:
                y = top.center[1] - top.size[1] / 2 + book.size[1] / 2 + rng.uniform(0.0, 0.03)
                pose = shelf.pose_at(x + thick / 2, y, top.center[2], 0.0)
                layout.add(book, pose, shelf, "inside")
                x += thick + rng.uniform(0.0005, 0.004)
        if rng.random() < 0.5:
            obj = living.ornament(pick(rng, ["globe", "box", "figure"]))
            layout.place_on(obj, shelf, board, yaw=0.0, spread=0.2, area=(0.45, 0, 1, 1), relation="inside")


def _plants(layout: Layout, floor: Placed) -> None:
    """In corners of the room."""
    rng = layout.rng
    middle = layout.outline.mean(axis=0)
    for corner in rng.permutation(len(layout.outline))[: int(rng.integers(0, 3))]:
        way = middle - layout.outline[corner]
        way = way / np.linalg.norm(way)
        shape = living.plant(pick(rng, [0.9, 1.1, 1.4]))

        def near(corner: int = int(corner), way: np.ndarray = way) -> list[float]:
            """A place in the corner."""
            at = layout.outline[corner] + way * rng.uniform(0.45, 0.65) + rng.normal(0, 0.03, 2)
            return [*at, 0.0, rng.uniform(-np.pi, np.pi)]

        layout.place(shape, near, floor)

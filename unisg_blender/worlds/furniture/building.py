"""Floors, walls, doors and what is fixed to a room."""

from __future__ import annotations

from functools import cache

import numpy as np

from .kit import Furniture, Solid, StandingSurface, asset, block, lathe, prism, rod

WALL_THICKNESS = 0.12
FLOOR_THICKNESS = 0.10


@cache
def floor(outline: tuple[tuple[float, float], ...], material: str) -> Furniture:
    """The floor of a room: its outline, counter-clockwise; the origin lies in its upper side.

    At most one corner may point inwards.
    """
    low, high = np.min(outline, axis=0), np.max(outline, axis=0)
    middle = (*((low + high) / 2).tolist(), 0.0)
    corners = np.array(outline)
    before, after = corners - np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0) - corners
    bend = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    slab = prism(material, np.roll(corners, -int(np.argmin(bend)), axis=0), -FLOOR_THICKNESS, 0.0)
    return asset("Floor", [slab], {"top": StandingSurface(middle, tuple((high - low).tolist()))}, origin="own")


@cache
def wall(
    length: float,
    height: float,
    material: str,
    start_miter: float = 0.0,
    end_miter: float = 0.0,
    opening: tuple[float, float, float, float] | None = None,
) -> Furniture:
    """A wall; front (-y) towards the room.

    Seen from the room its front runs ``length`` metres along x; at its back the two
    ends reach further by the miters, so that neighbours close the corner.
    ``opening`` is (middle along x, sill, width, height).
    """
    half, t = length / 2, WALL_THICKNESS
    if opening is None:
        pieces = [_wall_piece(material, -half, half, 0, height, start_miter, end_miter)]
    else:
        x, sill, width, tall = opening
        left, right = x - width / 2, x + width / 2
        lintel = "door" if sill == 0 else material  # so that doors show from above
        pieces = [
            _wall_piece(material, -half, left, 0, height, start_miter, 0),
            _wall_piece(material, right, half, 0, height, 0, end_miter),
            block(lintel, (width - 2e-4, t - 2e-4, height - sill - tall), (x, 0, sill + tall)),
        ]
        if sill > 0:
            pieces.append(block(material, (width - 2e-4, t - 2e-4, sill), (x, 0, 0)))
    return asset("Wall", pieces, origin="own")


def _wall_piece(
    material: str, left: float, right: float, low: float, high: float, start_miter: float, end_miter: float
) -> Solid:
    t = WALL_THICKNESS / 2
    outline = [(left, -t), (right, -t), (right + end_miter, t), (left - start_miter, t)]
    return prism(material, outline, low, high)


@cache
def double_door(width: float, height: float, material: str = "door") -> Furniture:
    """Two leaves with portholes and steel kick plates, for an opening of that size."""
    parts = []
    for side in (-1, 1):
        x = side * width / 4
        parts += [
            block(material, (width / 2 - 0.006, 0.045, height - 0.01), (x, 0, 0)),
            block("steel", (width / 2 - 0.06, 0.049, 0.25), (x, 0, 0.05)),
            block("glass", (0.22, 0.053, 0.5), (x, 0, 1.35)),
            rod("chrome", 0.012, (side * 0.08, -0.05, 0.95), (side * 0.08, -0.05, 1.25), 6),
        ]
    return asset("Door", parts)


@cache
def house_door(width: float, height: float, material: str = "birch") -> Furniture:
    """One panelled leaf with handles, for an opening of that size."""
    handles = [rod("brass", 0.012, (width / 2 - 0.08, y, 1.02), (width / 2 - 0.2, y, 1.02), 6) for y in (-0.045, 0.045)]
    panels = [block("linen", (width - 0.3, 0.048, height * 0.36), (0, 0, z)) for z in (0.15, height * 0.53)]
    return asset("Door", [block(material, (width - 0.01, 0.04, height - 0.01)), *panels, *handles])


@cache
def window(width: float, height: float) -> Furniture:
    """A window of two panes for an opening of that size."""
    frame = 0.06
    bars = [
        block("white", (width - 0.01, 0.07, frame)),
        block("white", (width - 0.01, 0.07, frame), (0, 0, height - frame - 0.01)),
    ]
    posts = [
        block("white", (frame, 0.068, height - 2 * frame - 0.012), (x, 0, frame + 0.001))
        for x in (-width / 2 + frame / 2 + 0.006, 0.0, width / 2 - frame / 2 - 0.006)
    ]
    panes = [
        block("glass", (width / 2 - 1.5 * frame - 0.008, 0.012, height - 2 * frame - 0.014), (x, 0, frame + 0.002))
        for x in (-width / 4 + frame / 4, width / 4 - frame / 4)
    ]
    return asset("Window", [*bars, *posts, *panes])


@cache
def ceiling_rail(length: float) -> Furniture:
    """The steel girder below the ceiling that lamps hang from; the ceiling itself is left out, to look in."""
    return asset("Ceiling Rail", [block("steel", (length, 0.10, 0.08))])


@cache
def supply_panel(width: float) -> Furniture:
    """Gas and power outlets in a steel panel, to be fixed to a wall."""
    outlets = [
        block(color, (0.07, 0.02, 0.07), (-width / 2 + 0.12 + 0.13 * i, -0.045, 0.14))
        for i, color in enumerate(("white", "black", "yellow", "green", "blue", "grey")[: int((width - 0.1) / 0.13)])
    ]
    return asset("Supply Panel", [block("steel", (width, 0.07, 0.35)), *outlets])


@cache
def glove_dispenser(boxes: int) -> Furniture:
    """Glove boxes one above another in a rack, to be fixed to a wall."""
    parts = [block("steel", (0.28, 0.02, 0.14 * boxes + 0.04), (0, 0.06, 0))]
    for i in range(boxes):
        color = ("blue", "green", "white")[i % 3]
        parts.append(block(color, (0.25, 0.10, 0.13), (0, -0.001, 0.02 + 0.14 * i)))
        parts.append(block("white", (0.12, 0.004, 0.05), (0, -0.0535, 0.06 + 0.14 * i)))
    return asset("Glove Dispenser", parts)


@cache
def light_box(width: float) -> Furniture:
    """A lit panel to look at x-ray pictures, to be fixed to a wall."""
    pictures = int(width // 0.4)
    films = [
        block("screen", (0.32, 0.012, 0.40), (0.4 * (i - (pictures - 1) / 2), -0.045, 0.07)) for i in range(pictures)
    ]
    return asset("Light Box", [block("white", (width, 0.08, 0.55)), *films])


@cache
def wall_clock(radius: float) -> Furniture:
    """A round clock, to be fixed to a wall."""
    face = rod("white", radius, (0, 0.02, radius), (0, -0.02, radius), 16)
    hands = [
        rod("black", 0.006, (0, -0.025, radius), (dx * radius, -0.025, radius + dz * radius), 4)
        for dx, dz in ((0.5, 0.2), (-0.1, 0.75))
    ]
    return asset("Clock", [face, *hands])


@cache
def picture(width: float, height: float, art: str) -> Furniture:
    """A framed picture, to be fixed to a wall."""
    return asset(
        "Picture",
        [
            block("walnut", (width, 0.03, height)),
            block("paper", (width - 0.06, 0.034, height - 0.06), (0, -0.002, 0.03)),
            block(art, (width - 0.2, 0.038, height - 0.2), (0, -0.004, 0.10)),
        ],
    )


@cache
def curtain(width: float, height: float, material: str) -> Furniture:
    """A gathered curtain, to be fixed beside a window."""
    folds = max(3, round(width / 0.08))
    parts = [
        lathe(
            material,
            [(0, 0), (width / folds / 2, 0.0), (width / folds / 2.4, height), (0, height)],
            ((i + 0.5) / folds * width - width / 2, 0, 0),
            6,
        )
        for i in range(folds)
    ]
    return asset("Curtain", parts)

"""What stands along the walls: cabinets, shelves, desks, bins, and seats on wheels."""

from __future__ import annotations

from functools import cache

import numpy as np

from .kit import Furniture, StandingSurface, asset, block, lathe, rod


@cache
def cabinet(width: float, height: float, color: str, glazed: bool, body: str = "plastic") -> Furniture:
    """A closed cabinet with two doors."""
    depth = 0.5
    doors, handles = [], []
    for side in (-1, 1):
        doors.append(
            block(color, (width / 2 - 0.02, 0.018, height - 0.16), (side * width / 4, -depth / 2 + 0.009, 0.12))
        )
        handles.append(block("chrome", (0.015, 0.02, 0.18), (side * 0.04, -depth / 2 - 0.0105, height * 0.5)))
        if glazed:
            size = (width / 2 - 0.12, 0.006, height * 0.45)
            doors.append(block("glass", size, (side * width / 4, -depth / 2 - 0.0032, height * 0.48)))
    parts = [
        block("grey", (width - 0.04, depth - 0.06, 0.10), (0, 0.01, 0)),
        block(body, (width, depth - 0.02, height - 0.101), (0, 0.01, 0.101)),
        *doors,
        *handles,
    ]
    return asset("Cabinet", parts, {"top": StandingSurface((0, 0.01, height), (width, depth - 0.02))})


@cache
def shelf(width: float, height: float, depth: float, boards: int, material: str, category: str = "Shelf") -> Furniture:
    """An open shelf; its surfaces are "board 0" (lowest) and up, as much headroom as there is above each."""
    thick = 0.022
    levels = np.linspace(0.08, height - thick, boards + 1)
    inner = width - 2 * thick
    parts = [
        *(block(material, (thick, depth, height), (side * (width / 2 - thick / 2), 0, 0)) for side in (-1, 1)),
        *(block(material, (inner - 0.001, depth - 0.012, thick), (0, -0.004, float(z))) for z in levels),
        block(material, (inner - 0.001, 0.008, height - 0.1), (0, depth / 2 - 0.005, 0.081)),
    ]
    room = float(levels[1] - levels[0]) - thick
    surfaces = {
        f"board {i}": StandingSurface((0, -0.006, float(z) + thick), (inner - 0.01, depth - 0.03), room)
        for i, z in enumerate(levels[:-1])
    }
    return asset(category, parts, surfaces)


@cache
def desk(width: float, material: str) -> Furniture:
    """A computer desk with a pedestal of drawers on one side."""
    depth, height = 0.6, 0.75
    parts = [
        block(material, (width, depth, 0.03), (0, 0, height - 0.03)),
        block("grey", (0.03, depth - 0.06, height - 0.031), (-width / 2 + 0.04, 0, 0)),
        block("plastic", (0.38, depth - 0.06, height - 0.031), (width / 2 - 0.21, 0, 0)),
        *(
            block("white", (0.34, 0.015, 0.2), (width / 2 - 0.21, -depth / 2 + 0.021, 0.06 + 0.22 * i))
            for i in range(3)
        ),
        block("grey", (width - 0.48, 0.02, 0.3), (-0.19, depth / 2 - 0.06, height - 0.332)),
    ]
    return asset("Desk", parts, {"top": StandingSurface((0, 0, height), (width, depth))})


@cache
def keyboard() -> Furniture:
    """A keyboard with rows of keys."""
    rows = [block("grey", (0.40, 0.018, 0.004), (0, -0.048 + 0.024 * i, 0.0152)) for i in range(5)]
    return asset("Keyboard", [block("dark", (0.44, 0.14, 0.015)), *rows])


@cache
def stool(height: float, color: str) -> Furniture:
    """A round seat on five castors."""
    feet = []
    for angle in np.radians(90 + 72 * np.arange(5)):
        x, y = 0.2 * np.cos(angle), 0.2 * np.sin(angle)
        feet += [rod("chrome", 0.014, (0.02 * np.cos(angle), 0.02 * np.sin(angle), 0.085), (x, y, 0.07), 6)]
        feet += [rod("rubber", 0.025, (x - 0.012, y, 0.026), (x + 0.012, y, 0.026), 8)]
    seat = lathe(color, [(0, 0), (0.165, 0), (0.175, 0.03), (0.16, 0.06), (0, 0.06)], (0, 0, height - 0.06), 12)
    return asset("Stool", [*feet, rod("chrome", 0.025, (0, 0, 0.06), (0, 0, height - 0.061), 8), seat])


@cache
def waste_bin(color: str, height: float) -> Furniture:
    """A bag stand with a coloured lid (yellow: infectious, black: household)."""
    parts = [
        block("grey", (0.38, 0.38, 0.05)),
        block("plastic", (0.34, 0.34, height - 0.112), (0, 0, 0.051), taper=1.06),
        block(color, (0.38, 0.40, 0.05), (0, 0, height - 0.05)),
        block("chrome", (0.12, 0.05, 0.02), (0, -0.21, 0.015)),
    ]
    return asset("Waste Bin", parts)


@cache
def linen_hamper(color: str) -> Furniture:
    """A bag for used linen in a wheeled frame."""
    posts = [rod("chrome", 0.012, (x, y, 0.05), (x, y, 0.88), 6) for x in (-0.22, 0.22) for y in (-0.22, 0.22)]
    wheels = [
        rod("rubber", 0.025, (x - 0.01, y, 0.025), (x + 0.01, y, 0.025), 8)
        for x in (-0.22, 0.22)
        for y in (-0.22, 0.22)
    ]
    bars = [block("chrome", (0.025, 0.466, 0.02), (x, 0, 0.8805)) for x in (-0.22, 0.22)]
    bars += [block("chrome", (0.412, 0.025, 0.02), (0, y, 0.8805)) for y in (-0.22, 0.22)]
    bag = lathe(color, [(0, 0.10), (0.16, 0.10), (0.2, 0.45), (0.2, 0.86), (0.12, 0.86), (0, 0.70)], sides=10)
    return asset("Linen Hamper", [*posts, *wheels, *bars, bag])


@cache
def wash_basin(width: float) -> Furniture:
    """A scrub basin on a cupboard, with a long tap."""
    depth = 0.5
    walls = [
        *(block("steel", (width, 0.03, 0.14), (0, y, 0.761)) for y in (-depth / 2 + 0.015, depth / 2 - 0.015)),
        *(block("steel", (0.03, depth - 0.062, 0.14), (x, 0, 0.761)) for x in (-width / 2 + 0.015, width / 2 - 0.015)),
    ]
    tap = [
        rod("chrome", 0.014, (0, 0.2, 0.902), (0, 0.2, 1.15), 6),
        rod("chrome", 0.012, (0, 0.187, 1.14), (0, -0.02, 1.1), 6),
    ]
    parts = [
        block("plastic", (width - 0.02, depth - 0.06, 0.70), (0, 0.02, 0)),
        block("steel", (width, depth, 0.06), (0, 0, 0.7005)),
        *walls,
        *tap,
    ]
    return asset("Wash Basin", parts)

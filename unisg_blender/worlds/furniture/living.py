"""What makes a home: television, lamps, plants, books, dishes and textiles."""

from __future__ import annotations

from functools import cache

import numpy as np

from .kit import Furniture, StandingSurface, asset, ball, block, lathe, rod, turned


@cache
def television(width: float) -> Furniture:
    """A flat television on two feet."""
    height = round(width * 0.57, 3)
    feet = [block("black", (0.03, 0.22, 0.015), (x, 0, 0)) for x in (-width * 0.3, width * 0.3)]
    necks = [block("black", (0.025, 0.03, 0.05), (x, 0, 0.0151)) for x in (-width * 0.3, width * 0.3)]
    parts = [*feet, *necks, block("black", (width, 0.05, height), (0, 0, 0.066)),
             block("screen", (width - 0.03, 0.004, height - 0.03), (0, -0.0272, 0.081))]  # fmt: skip
    return asset("Television", parts)


@cache
def television_stand(width: float, material: str) -> Furniture:
    """A low board with two drawers and an open middle."""
    depth, height = 0.4, 0.5
    third = width / 3
    parts = [
        *(block("black", (0.05, 0.3, 0.08), (x, 0, 0)) for x in (-width / 2 + 0.1, width / 2 - 0.1)),
        block(material, (width, depth, 0.03), (0, 0, 0.081)),
        block(material, (width, depth, 0.03), (0, 0, height - 0.03)),
        *(
            block(material, (third - 0.02, depth - 0.02, height - 0.144), (side * third, 0.01, 0.1125))
            for side in (-1, 1)
        ),
        *(block("chrome", (0.12, 0.012, 0.012), (side * third, -depth / 2 + 0.012, 0.3)) for side in (-1, 1)),
        block(material, (third - 0.002, 0.012, height - 0.144), (0, depth / 2 - 0.02, 0.1125)),
    ]
    niche = StandingSurface((0, -0.02, 0.111), (third - 0.04, depth - 0.08), height - 0.15)
    return asset("Television Stand", parts, {"top": StandingSurface((0, 0, height), (width, depth)), "niche": niche})


@cache
def table_lamp(color: str) -> Furniture:
    """A lamp with a cloth shade, 0.45 high."""
    foot = lathe("porcelain", [(0, 0), (0.07, 0), (0.08, 0.08), (0.02, 0.20), (0, 0.20)], sides=10)
    shade = lathe(color, [(0, 0), (0.14, 0), (0.09, 0.18), (0, 0.18)], (0, 0, 0.27), 12)
    return asset("Table Lamp", [foot, rod("brass", 0.008, (0, 0, 0.201), (0, 0, 0.269), 6), shade])


@cache
def floor_lamp(height: float, color: str) -> Furniture:
    """A standing lamp."""
    foot = lathe("black", [(0, 0), (0.15, 0), (0.14, 0.025), (0, 0.025)], sides=12)
    shade = lathe(color, [(0, 0), (0.2, 0), (0.14, 0.26), (0, 0.26)], (0, 0, height - 0.26), 12)
    return asset("Floor Lamp", [foot, rod("black", 0.013, (0, 0, 0.026), (0, 0, height - 0.261), 6), shade])


@cache
def rug(width: float, depth: float, color: str) -> Furniture:
    """A rug with a border."""
    field = block("linen", (width - 0.2, depth - 0.2, 0.001), (0, 0, 0.0081))
    return asset(
        "Rug", [block(color, (width, depth, 0.008)), field], {"top": StandingSurface((0, 0, 0.0091), (width, depth))}
    )


@cache
def book(width: float, depth: float, thick: float, color: str) -> Furniture:
    """A book, lying: ``width`` across, its pages to the front."""
    return asset(
        "Book",
        [
            block(color, (width, depth, thick)),
            block("paper", (width - 0.01, 0.002, thick - 0.008), (0, -depth / 2 - 0.0012, 0.004)),
        ],
    )


@cache
def standing_book(thick: float, depth: float, height: float, color: str) -> Furniture:
    """A book, upright on a shelf: spine to the front."""
    label = block("paper", (thick * 0.6, 0.001, height * 0.2), (0, -depth / 2 - 0.0006, height * 0.6))
    return asset("Book", [block(color, (thick, depth, height)), label])


@cache
def vase(radius: float, flowers: bool) -> Furniture:
    """A vase, with or without flowers."""
    parts = [
        lathe(
            "terracotta",
            [(0, 0), (0.6 * radius, 0), (radius, 1.6 * radius), (0.45 * radius, 3 * radius), (0, 3 * radius)],
            sides=12,
        )
    ]
    if flowers:
        for i, angle in enumerate(np.radians([10, 130, 250])):
            tip = (0.7 * radius * np.cos(angle), 0.7 * radius * np.sin(angle), 5 * radius + 0.02 * i)
            foot = (0.2 * radius * np.cos(angle), 0.2 * radius * np.sin(angle), 3.001 * radius)
            parts += [
                rod("leaf", 0.004, foot, tip, 4),
                ball(("red", "yellow", "white")[i], (0.03, 0.03, 0.025), (tip[0], tip[1], tip[2] + 0.0255), 6, 3),
            ]
    return asset("Vase", parts)


@cache
def plant(height: float) -> Furniture:
    """A plant with big leaves in a pot."""
    pot = lathe("terracotta", [(0, 0), (0.12, 0), (0.16, 0.26), (0, 0.26)], sides=12)
    leaves = []
    for i, angle in enumerate(np.radians(np.arange(7) * 137.5)):
        top = 0.45 + (height - 0.5) * (i + 1) / 7
        reach = 0.22 - 0.012 * i
        at = (reach * np.cos(angle), reach * np.sin(angle), top)
        leaves.append(
            rod(
                "leaf", 0.006, (0.03 * np.cos(angle), 0.03 * np.sin(angle), 0.261), (at[0] * 0.55, at[1] * 0.55, top), 4
            )
        )
        leaves.append(ball("leaf", (0.13, 0.07, 0.03), (0, 0, 0), 6, 3))
        leaves[-1] = turned(leaves[-1]._replace(points=leaves[-1].points + at), float(np.degrees(angle)), at[:2])
    return asset("Plant", [pot, *leaves])


@cache
def cup(color: str) -> Furniture:
    """A mug with a handle."""
    body = lathe(color, [(0, 0), (0.036, 0), (0.04, 0.09), (0.035, 0.09), (0.032, 0.008), (0, 0.008)], sides=12)
    handle = block(color, (0.022, 0.01, 0.05), (0.0505, 0, 0.02))
    return asset("Cup", [body, handle])


@cache
def plate(radius: float) -> Furniture:
    """A dinner plate."""
    profile = [(0, 0), (0.6 * radius, 0), (radius, 0.02), (0.97 * radius, 0.022), (0.6 * radius, 0.006), (0, 0.006)]
    return asset("Plate", [lathe("porcelain", profile, sides=16)])


@cache
def fruit_bowl(radius: float) -> Furniture:
    """A wooden bowl of fruit."""
    bowl = lathe("oak", [(0, 0), (0.5 * radius, 0), (radius, 0.5 * radius), (0.93 * radius, 0.5 * radius),
                         (0.46 * radius, 0.01), (0, 0.01)], sides=14)  # fmt: skip
    size = 0.3 * radius
    fruit = [
        ball(
            color, (size, size, size), (0.45 * radius * np.cos(a), 0.45 * radius * np.sin(a), 0.012 + 1.25 * size), 8, 4
        )
        for color, a in (("red", 0.3), ("yellow", 2.4), ("green", 4.5))
    ]
    return asset("Bowl", [bowl, *fruit])


@cache
def remote() -> Furniture:
    """A remote control."""
    return asset("Remote", [block("black", (0.045, 0.17, 0.018)), block("red", (0.01, 0.01, 0.003), (0, 0.06, 0.0181))])


@cache
def ornament(kind: str) -> Furniture:
    """A small object to look at: a "globe", a "box" or a "figure"."""
    if kind == "globe":
        stand = lathe("walnut", [(0, 0), (0.05, 0), (0.02, 0.03), (0, 0.03)], sides=8)
        return asset("Ornament", [stand, ball("blue", (0.07, 0.07, 0.07), (0, 0, 0.1005), 10, 6)])
    if kind == "box":
        return asset(
            "Ornament", [block("oak", (0.14, 0.1, 0.06)), block("walnut", (0.145, 0.105, 0.02), (0, 0, 0.061))]
        )
    body = lathe("brass", [(0, 0), (0.04, 0), (0.02, 0.08), (0.035, 0.13), (0, 0.14)], sides=8)
    return asset("Ornament", [body, ball("brass", (0.025, 0.025, 0.03), (0, 0, 0.171), 8, 4)])

"""Instruments and supplies: each lies flat, handle at +y, working end at -y."""

from __future__ import annotations

from functools import cache

import numpy as np

from .kit import Furniture, Solid, StandingSurface, asset, block, lathe, rod, turned


@cache
def scalpel() -> Furniture:
    """A blade on a flat handle."""
    return asset(
        "Scalpel",
        [
            block("steel", (0.011, 0.115, 0.006), (0, 0.0225, 0)),
            block("green", (0.0112, 0.03, 0.0062), (0, 0.055, 0)),
            block("chrome", (0.009, 0.045, 0.0015), (0, -0.0575, 0.002), taper=0.8),
        ],
    )


@cache
def forceps() -> Furniture:
    """Two springy arms that meet at the back."""
    arms = [turned(block("chrome", (0.007, 0.148, 0.010), (x, 0, 0)), -x * 500, (0, 0.07)) for x in (-0.005, 0.005)]
    return asset("Forceps", [*arms, block("chrome", (0.012, 0.016, 0.011), (0, 0.072, 0))])


def _ringed(material: str, length: float, spread: float, jaw: Solid) -> list[Solid]:
    """Scissor-like instruments: two ring handles, shanks that cross, and a jaw."""
    parts = [jaw, rod("chrome", 0.006, (0, 0, 0), (0, 0, 0.012), 8)]
    for side in (-1, 1):
        x, y = side * spread, length * 0.40
        parts.append(rod(material, 0.0045, (0, 0, 0.0055), (x, y - 0.014, 0.0055), 6))
        for angle in np.radians(np.arange(0, 360, 60)):
            at = (x + 0.013 * np.cos(angle), y + 0.013 * np.sin(angle), 0)
            parts.append(turned(block(material, (0.006, 0.0125, 0.008), at), float(np.degrees(angle)), at[:2]))
    return parts


@cache
def scissors() -> Furniture:
    """Straight scissors, a little open."""
    blades = rod("chrome", 0.006, (0, -0.001, 0.006), (0, -0.075, 0.006), 4, 0.002)
    return asset("Scissors", _ringed("chrome", 0.15, 0.020, blades))


@cache
def clamp() -> Furniture:
    """A haemostatic clamp, closed."""
    return asset("Clamp", _ringed("steel", 0.16, 0.018, block("steel", (0.006, 0.06, 0.007), (0, -0.037, 0.002))))


@cache
def needle_holder() -> Furniture:
    """A needle holder with gold rings."""
    return asset(
        "Needle Holder", _ringed("brass", 0.18, 0.021, block("chrome", (0.010, 0.04, 0.009), (0, -0.03, 0.001)))
    )


@cache
def retractor() -> Furniture:
    """A handle with a hooked rake."""
    return asset(
        "Retractor",
        [
            block("titanium", (0.018, 0.10, 0.010), (0, 0.06, 0.002)),
            rod("titanium", 0.006, (0, 0.009, 0.006), (0, -0.085, 0.006), 6),
            block("titanium", (0.050, 0.012, 0.008), (0, -0.092, 0.001)),
            *(block("titanium", (0.008, 0.014, 0.020), (x, -0.1055, 0.001)) for x in (-0.02, 0.0, 0.02)),
        ],
    )


@cache
def mallet() -> Furniture:
    """A bone mallet."""
    head = rod("titanium", 0.02, (-0.045, -0.085, 0.02), (0.045, -0.085, 0.02), 10)
    return asset("Mallet", [head, rod("black", 0.011, (0, -0.064, 0.02), (0, 0.11, 0.014), 8)])


@cache
def syringe(size: float) -> Furniture:
    """A syringe with plunger and needle cap; ``size`` is 1 for 10 ml."""
    radius = 0.009 * size
    flange = block("white", (4.2 * radius, 0.003, 2 * radius), (0, 0.0455 * size, 0))
    return asset(
        "Syringe",
        [
            rod("clear", radius, (0, -0.045 * size, radius), (0, 0.0435 * size, radius), 8),
            rod("white", radius * 0.5, (0, 0.0475 * size, radius), (0, 0.075 * size, radius), 6),
            rod("white", radius * 0.95, (0, 0.0752 * size, radius), (0, 0.078 * size, radius), 8),
            rod("blue", radius * 0.4, (0, -0.085 * size, radius), (0, -0.0455 * size, radius), 6),
            flange,
        ],
    )


@cache
def swab(kind: str) -> Furniture:
    """A gauze swab: a "stack" of ten, "folded", or a used, "crumpled" one."""
    if kind == "crumpled":
        lump = lathe("gauze", [(0, 0), (0.04, 0), (0.05, 0.015), (0.028, 0.032), (0, 0.034)], sides=7)
        stain = lathe("red", [(0, 0.0345), (0.015, 0.0345), (0.01, 0.038), (0, 0.038)], sides=6)
        return asset("Swab", [lump, stain])
    if kind == "stack":
        layers = [turned(block("gauze", (0.10, 0.10, 0.009), (0, 0, 0.0095 * i)), 4 * (-1) ** i) for i in range(4)]
        return asset("Swab", [*layers, block("blue", (0.105, 0.01, 0.0385), (0, 0, 0))])
    return asset("Swab", [block("gauze", (0.10, 0.10, 0.008)), block("blue", (0.10, 0.004, 0.001), (0, 0.02, 0.0081))])


@cache
def kidney_dish(length: float) -> Furniture:
    """A kidney-shaped dish: a bent floor and a wall of facets."""
    width, height, wall = length * 0.48, 0.045, 0.006
    turn = np.linspace(0, 2 * np.pi, 14, endpoint=False)
    x = length / 2 * np.cos(turn)
    y = width / 2 * np.sin(turn) + 0.22 * width * (np.cos(turn) ** 2 - 0.5)
    parts = []
    for a in range(14):
        b = (a + 1) % 14
        middle, run = ((x[a] + x[b]) / 2, (y[a] + y[b]) / 2), (x[b] - x[a], y[b] - y[a])
        facet = block("chrome", (float(np.hypot(*run)) + 0.001, wall, height), (*middle, 0.0))
        parts.append(turned(facet, float(np.degrees(np.arctan2(run[1], run[0]))), middle))
    for share in (-0.3, 0.0, 0.3):
        at = (share * length, 0.22 * width * (4 * share**2 - 0.5), 0.0)
        parts.append(block("chrome", (length * 0.32, width * 0.74, 0.004), at))
    return asset(
        "Kidney Dish", parts, {"inside": StandingSurface((0, -0.05 * width, 0.004), (length * 0.72, width * 0.5))}
    )


@cache
def bowl(radius: float, fill: str) -> Furniture:
    """A steel bowl with a fluid ("iodine", "clear")."""
    shell = lathe(
        "chrome",
        [
            (0, 0),
            (0.55 * radius, 0),
            (radius, 0.55 * radius),
            (0.94 * radius, 0.55 * radius),
            (0.52 * radius, 0.01),
            (0, 0.01),
        ],
        sides=14,
    )
    fluid = lathe(
        fill, [(0, 0.011), (0.53 * radius, 0.011), (0.75 * radius, 0.3 * radius), (0, 0.3 * radius)], sides=14
    )
    return asset("Bowl", [shell, fluid])


@cache
def tray(width: float, depth: float) -> Furniture:
    """A sterilisation tray with a rim and two handles."""
    rim, height = 0.006, 0.045
    walls = [
        *(block("steel", (width, rim, height), (0, y, 0)) for y in (-depth / 2 + rim / 2, depth / 2 - rim / 2)),
        *(
            block("steel", (rim, depth - 2 * rim - 0.001, height), (x, 0, 0))
            for x in (-width / 2 + rim / 2, width / 2 - rim / 2)
        ),
    ]
    handles = [
        block("chrome", (0.012, 0.10, 0.012), (x, 0, height + 0.001)) for x in (-width / 2 + 0.006, width / 2 - 0.006)
    ]
    base = block("steel", (width - 2 * rim - 0.001, depth - 2 * rim - 0.001, 0.004))
    inside = StandingSurface((0, 0, 0.004), (width - 2 * rim - 0.004, depth - 2 * rim - 0.004))
    return asset("Tray", [base, *walls, *handles], {"inside": inside})


@cache
def implant(size: float) -> Furniture:
    """A knee implant's femoral part: two condyles and a bridge."""
    s = size
    condyles = [
        lathe(
            "titanium",
            [(0, 0), (0.013 * s, 0.002), (0.014 * s, 0.02 * s), (0.008 * s, 0.032 * s), (0, 0.032 * s)],
            (x, -0.006 * s, 0),
            8,
        )
        for x in (-0.019 * s, 0.019 * s)
    ]
    bridge = block("titanium", (0.05 * s, 0.018 * s, 0.024 * s), (0, 0.018 * s, 0.0))
    return asset("Implant", [*condyles, bridge])


@cache
def implant_box(width: float) -> Furniture:
    """An open box with a foam bed for the implant."""
    depth, height, wall = width * 0.62, 0.06, 0.005
    walls = [
        *(block("blue", (width, wall, height), (0, y, 0)) for y in (-depth / 2 + wall / 2, depth / 2 - wall / 2)),
        *(
            block("blue", (wall, depth - 2 * wall - 0.001, height), (x, 0, 0))
            for x in (-width / 2 + wall / 2, width / 2 - wall / 2)
        ),
    ]
    bed = block("dark", (width - 2 * wall - 0.001, depth - 2 * wall - 0.001, 0.02))
    return asset("Implant Box", [bed, *walls], {"inside": StandingSurface((0, 0, 0.02), (width - 0.02, depth - 0.02))})


@cache
def supply_box(color: str, width: float) -> Furniture:
    """A carton of gloves, masks or sutures."""
    size = (width, width * 0.55, width * 0.42)
    label = block("white", (width * 0.5, 0.002, width * 0.2), (0, -width * 0.275, width * 0.1))
    return asset("Supply Box", [block(color, size), label], {"top": StandingSurface((0, 0, size[2]), size[:2])})

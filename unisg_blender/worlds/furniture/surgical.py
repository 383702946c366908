"""The sterile side of an operating room: table, patient, lamp and the stands around them."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np

from .kit import Furniture, StandingSurface, asset, ball, block, lathe, rod

PATIENT_HEIGHT = 0.27


@cache
def operating_table(length: float, height: float) -> Furniture:
    """A table on a pedestal; the head end lies at +y, the feet at -y."""
    width, pad = 0.52, 0.07
    top = height - pad
    cut = [-0.5, -0.08, 0.30, 0.5]  # leg, trunk and head sections, as shares of the length
    sections = [
        block("mattress", (width, (b - a) * length - 0.012, pad), (0, (a + b) / 2 * length, top))
        for a, b in pairwise(cut)
    ]
    rails = [
        block("chrome", (0.02, length * 0.9, 0.03), (side * (width / 2 - 0.03), 0, top - 0.05)) for side in (-1, 1)
    ]
    parts = [
        block("steel", (0.48, 0.95, 0.10), (0, 0.1, 0), taper=0.92),
        block("steel", (0.26, 0.34, top - 0.135), (0, 0.12, 0.102)),
        block("steel", (width - 0.1, length * 0.94, 0.03), (0, 0, top - 0.032)),
        *sections,
        *rails,
    ]
    return asset("Operating Table", parts, {"top": StandingSurface((0, 0, height), (width, length))})


@cache
def patient(length: float, side: int) -> Furniture:
    """A patient on the back under a drape, head at +y; the knee at the sign ``side`` of x is bare (-1: the right one).

    The surfaces "knee", "belly" and "face" are where it is operated, where the
    drape is level, and the mouth.
    """
    unit = length / 1.75
    hip, shoulder, neck = -0.02 * unit, 0.50 * unit, 0.60 * unit
    legs = []
    for leg in (-1, 1):
        x = 0.10 * leg
        cloth = "iodine" if leg == side else "drape"
        legs += [
            block("drape", (0.16, 0.42 * unit, 0.15), (x, hip - 0.21 * unit, 0.001), taper=0.9),
            block(cloth, (0.14, 0.16 * unit, 0.14), (x, hip - 0.505 * unit, 0.001), taper=0.9),
            block("drape", (0.13, 0.26 * unit, 0.12), (x, hip - 0.72 * unit, 0.001), taper=0.9),
        ]
    arms = []
    for arm in (-0.225, 0.225):
        arms += [block("drape", (0.055, 0.50 * unit, 0.07), (arm, shoulder - 0.27 * unit, 0.001), taper=0.9)]
        arms += [block("skin", (0.05, 0.14 * unit, 0.045), (arm, shoulder - 0.60 * unit, 0.001), taper=0.8)]
    parts = [
        *legs,
        *arms,
        block("drape", (0.38, shoulder - hip - 0.01, 0.19), (0, (shoulder + hip) / 2, 0), taper=0.88),
        block("skin", (0.10, neck - shoulder + 0.02, 0.09), (0, (shoulder + neck) / 2, 0.03)),
        ball("skin", (0.078, 0.105, 0.095), (0, neck + 0.095, 0.096)),
        block("drape_light", (0.14, 0.06, 0.10), (0, neck + 0.16, 0.01)),
        block("skin", (0.03, 0.03, 0.022), (0, neck + 0.09, 0.182), taper=0.6),
    ]
    knee = StandingSurface((0.10 * side, hip - 0.505 * unit, 0.141), (0.12, 0.14 * unit))
    belly = StandingSurface((0, (shoulder + hip) / 2 - 0.06, 0.19), (0.32, 0.34 * unit))
    face = StandingSurface((0, neck + 0.085, 0.19), (0.1, 0.1))
    return asset("Patient", parts, {"knee": knee, "belly": belly, "face": face})


@cache
def knee() -> Furniture:
    """The operating field on a knee: an adhesive film with a window and the incision line."""
    return asset(
        "Knee",
        [
            block("clear", (0.12, 0.13, 0.003)),
            block("skin", (0.08, 0.10, 0.003), (0, 0, 0.0031)),
            block("red", (0.006, 0.08, 0.001), (0, 0, 0.0062)),
        ],
    )


@cache
def surgical_lamp(radius: float, drop: float, reach: float) -> Furniture:
    """A lamp that hangs ``drop`` metres below its mount, its head ``reach`` metres in front of it (towards -y)."""
    joint = -0.55 * drop
    petals = [
        lathe("white", [(0, 0), (0.34 * radius, 0), (0.34 * radius, 0.09), (0, 0.09)], at, 10)
        for at in (
            (0.6 * radius, -reach, -drop),
            (-0.3 * radius, -reach + 0.52 * radius, -drop),
            (-0.3 * radius, -reach - 0.52 * radius, -drop),
        )
    ]
    glass = [
        lathe(
            "light",
            [(0, 0), (0.28 * radius, 0), (0.28 * radius, 0.01), (0, 0.01)],
            (0.0 + part.points[0, 0], part.points[0, 1], -drop - 0.011),
            10,
        )
        for part in petals
    ]
    parts = [
        rod("white", 0.11, (0, 0, -0.03), (0, 0, 0), 10),
        rod("white", 0.035, (0, 0, joint), (0, 0, -0.031), 8),
        block("white", (0.07, reach + 0.06, 0.06), (0, -reach / 2, joint - 0.062)),
        rod("white", 0.028, (0, -reach, -drop + 0.13), (0, -reach, joint - 0.063), 8),
        lathe("grey", [(0, 0), (0.42 * radius, 0), (0.25 * radius, 0.05), (0, 0.05)], (0, -reach, -drop + 0.08), 10),
        *petals,
        *glass,
        rod("grey", 0.015, (0, -reach, -drop - 0.10), (0, -reach, -drop + 0.079), 6),
    ]
    return _hung(parts)


def _hung(parts: list) -> Furniture:
    return asset("Surgical Lamp", parts, origin="own")


@cache
def mayo_stand(height: float) -> Furniture:
    """A tray on one leg at its back (+y), so that it reaches over the patient in front of it."""
    back, lip = 0.24, 0.012
    feet = [block("chrome", (0.04, 0.52, 0.04), (x, 0.0, 0.012)) for x in (-0.2, 0.2)]
    wheels = [
        rod("rubber", 0.02, (x - 0.012, y, 0.02), (x + 0.012, y, 0.02), 8) for x in (-0.2, 0.2) for y in (-0.22, 0.22)
    ]
    rims = [
        *(block("chrome", (0.60, lip, 0.020), (0, y, height - 0.001)) for y in (-0.2 + lip / 2, 0.2 - lip / 2)),
        *(
            block("chrome", (lip, 0.40 - 2 * lip - 0.001, 0.020), (x, 0, height - 0.001))
            for x in (-0.3 + lip / 2, 0.3 - lip / 2)
        ),
    ]
    parts = [
        *feet,
        *wheels,
        block("chrome", (0.44, 0.04, 0.04), (0, back, 0.013)),
        rod("chrome", 0.018, (0, back, 0.054), (0, back, height - 0.05), 8),
        block("chrome", (0.03, 0.24, 0.03), (0, back - 0.10, height - 0.049)),
        block("steel", (0.59, 0.39, 0.018), (0, 0, height - 0.018)),
        *rims,
    ]
    return asset("Mayo Stand", parts, {"top": StandingSurface((0, 0, height), (0.57, 0.37))})


@cache
def instrument_table(width: float, depth: float, height: float) -> Furniture:
    """A steel back table on wheels with a lower shelf."""
    legs = [
        rod("chrome", 0.016, (x, y, 0.08), (x, y, height - 0.031), 6)
        for x in (-width / 2 + 0.05, width / 2 - 0.05)
        for y in (-depth / 2 + 0.05, depth / 2 - 0.05)
    ]
    wheels = [
        rod("rubber", 0.04, (*leg.points[0, :2] - (0.015, 0), 0.04), (*leg.points[0, :2] + (0.015, 0), 0.04), 8)
        for leg in legs
    ]
    parts = [
        block("steel", (width, depth, 0.03), (0, 0, height - 0.03)),
        block("steel", (width - 0.16, depth - 0.14, 0.02), (0, 0, 0.25)),
        *legs,
        *wheels,
    ]
    shelf = StandingSurface((0, 0, 0.27), (width - 0.18, depth - 0.16), height - 0.31)
    return asset("Instrument Table", parts, {"top": StandingSurface((0, 0, height), (width, depth)), "shelf": shelf})


@cache
def drape(width: float, depth: float) -> Furniture:
    """A folded-out sterile cloth."""
    return asset(
        "Drape",
        [block("drape", (width, depth, 0.005))],
        {"top": StandingSurface((0, 0, 0.005), (width, depth))},
    )


@cache
def kick_bucket(radius: float) -> Furniture:
    """A steel bucket on a wheeled ring."""
    wheels = [
        rod("rubber", 0.02, (x - 0.01, y, 0.02), (x + 0.01, y, 0.02), 8)
        for x, y in ((0.85 * radius, 0), (-0.42 * radius, 0.74 * radius), (-0.42 * radius, -0.74 * radius))
    ]
    bucket = lathe(
        "chrome",
        [
            (0, 0.06),
            (0.62 * radius, 0.06),
            (0.9 * radius, 0.33),
            (0.86 * radius, 0.33),
            (0.58 * radius, 0.075),
            (0, 0.075),
        ],
        sides=12,
    )
    ring = lathe("grey", [(0, 0.041), (radius, 0.041), (radius, 0.058), (0, 0.058)], sides=12)
    return asset(
        "Kick Bucket", [*wheels, ring, bucket], {"inside": StandingSurface((0, 0, 0.075), (0.8 * radius, 0.8 * radius))}
    )


@cache
def electrosurgical_unit(height: float) -> Furniture:
    """A generator with dials on a cart."""
    parts = [
        *_cart(0.48, 0.48, height - 0.22, "grey"),
        block("white", (0.42, 0.40, 0.20), (0, 0.01, height - 0.219)),
        block("screen", (0.18, 0.01, 0.08), (-0.08, -0.195, height - 0.13)),
        *(
            rod(color, 0.022, (x, -0.22, height - 0.14), (x, -0.191, height - 0.14), 8)
            for x, color in ((0.08, "yellow"), (0.15, "blue"))
        ),
        block("blue", (0.36, 0.02, 0.015), (0, -0.20, height - 0.20)),
    ]
    return asset("Electrosurgical Unit", parts, {"top": StandingSurface((0, 0.01, height - 0.019), (0.40, 0.38))})


@cache
def suction_unit(height: float) -> Furniture:
    """Two collecting canisters and a pump on a cart."""
    canisters = [
        lathe(color, [(0, 0), (0.07, 0), (0.08, 0.24), (0, 0.24)], (x, -0.05, 0.451), 10)
        for x, color in ((-0.1, "clear"), (0.1, "red"))
    ]
    lids = [rod("white", 0.082, (x, -0.05, 0.692), (x, -0.05, 0.72), 10) for x in (-0.1, 0.1)]
    parts = [
        *_cart(0.42, 0.40, 0.45, "grey"),
        *canisters,
        *lids,
        block("white", (0.34, 0.10, 0.20), (0, 0.12, 0.452)),
        rod("chrome", 0.012, (0, 0.12, 0.653), (0, 0.12, height), 6),
    ]
    return asset("Suction Unit", parts)


def _cart(width: float, depth: float, height: float, color: str) -> list:
    wheels = [
        rod("rubber", 0.04, (x - 0.015, y, 0.04), (x + 0.015, y, 0.04), 8)
        for x in (-width / 2 + 0.05, width / 2 - 0.05)
        for y in (-depth / 2 + 0.06, depth / 2 - 0.06)
    ]
    posts = [
        block(color, (0.025, 0.025, height - 0.134), (x, y, 0.112))
        for x in (-width / 2 + 0.03, width / 2 - 0.03)
        for y in (-depth / 2 + 0.03, depth / 2 - 0.03)
    ]
    return [
        *wheels,
        block(color, (width, depth, 0.03), (0, 0, 0.081)),
        *posts,
        block(color, (width, depth, 0.02), (0, 0, height - 0.02)),
    ]


@cache
def step_stool(height: float) -> Furniture:
    """A low step for people who are not tall enough."""
    legs = [block("chrome", (0.03, 0.03, height - 0.031), (x, y, 0)) for x in (-0.17, 0.17) for y in (-0.12, 0.12)]
    return asset("Step Stool", [*legs, block("rubber", (0.40, 0.30, 0.03), (0, 0, height - 0.03))])


@cache
def c_arm(opening: float) -> Furniture:
    """A mobile x-ray unit: a C of steel with tube and detector, on a cart behind it (+y)."""
    radius, height = opening / 2 + 0.12, 1.15
    angles = np.radians(np.arange(90, 271, 20))
    ring = [(0.0, radius * float(np.cos(a)) - 0.45, height - radius * float(np.sin(a))) for a in angles - np.pi / 2]
    arc = [rod("white", 0.045, a, b, 6) for a, b in pairwise(ring)]
    top, bottom = ring[-1], ring[0]
    low, high = sorted([top, bottom], key=lambda point: point[2])
    parts = [
        *arc,
        rod("grey", 0.15, (0, high[1], high[2] - 0.22), (0, high[1], high[2] - 0.05), 12),
        rod("white", 0.11, (0, low[1], low[2] + 0.05), (0, low[1], low[2] + 0.25), 10),
        block("white", (0.5, 0.55, 0.9), (0, 0.45, 0.12), taper=0.9),
        block("grey", (0.56, 0.75, 0.06), (0, 0.4, 0.061)),
        block("white", (0.14, 0.36, 0.14), (0, 0.05, height - 0.07)),
        *(rod("rubber", 0.06, (x - 0.02, y, 0.06), (x + 0.02, y, 0.06), 8) for x in (-0.3, 0.3) for y in (0.1, 0.7)),
        block("screen", (0.34, 0.03, 0.24), (0, 0.6, 1.03)),
    ]
    return asset("C-Arm", parts)

"""Sofas, chairs and tables of a home."""

from __future__ import annotations

from functools import cache

from .kit import Furniture, Solid, StandingSurface, asset, block, lathe, rod


@cache
def sofa(width: float, color: str) -> Furniture:
    """A sofa with arms; the surface "seat" carries cushions."""
    depth, arm = 0.9, 0.16
    inner = width - 2 * arm
    seats = 2 if width < 1.9 else 3
    cushions = [
        block(
            color,
            (inner / seats - 0.012, 0.62, 0.14),
            ((i - (seats - 1) / 2) * inner / seats, -0.12, 0.282),
            taper=0.97,
        )
        for i in range(seats)
    ]
    feet = [
        block("walnut", (0.06, 0.06, 0.06), (x, y, 0))
        for x in (-width / 2 + 0.1, width / 2 - 0.1)
        for y in (-0.36, 0.36)
    ]
    parts = [
        *feet,
        block(color, (width, depth - 0.04, 0.22), (0, 0, 0.061)),
        *cushions,
        block(color, (inner - 0.002, 0.22, 0.51), (0, depth / 2 - 0.13, 0.282), taper=0.96),
        *(block(color, (arm - 0.002, depth - 0.04, 0.34), (side * (width - arm) / 2, 0, 0.282)) for side in (-1, 1)),
    ]
    seat = StandingSurface((0, -0.12, 0.422), (inner - 0.1, 0.54))
    return asset("Sofa", parts, {"seat": seat})


@cache
def armchair(color: str) -> Furniture:
    """An armchair on four feet."""
    feet = [rod("walnut", 0.025, (x, y, 0), (x, y, 0.14), 6, 0.03) for x in (-0.34, 0.34) for y in (-0.34, 0.34)]
    parts = [
        *feet,
        block(color, (0.84, 0.80, 0.16), (0, 0, 0.141)),
        block(color, (0.55, 0.58, 0.12), (0, -0.10, 0.302), taper=0.96),
        block(color, (0.55, 0.18, 0.58), (0, 0.30, 0.302), taper=0.92),
        *(block(color, (0.13, 0.80, 0.30), (side * 0.353, 0, 0.302)) for side in (-1, 1)),
    ]
    return asset("Armchair", parts, {"seat": StandingSurface((0, -0.12, 0.422), (0.5, 0.46))})


@cache
def cushion(size: float, color: str) -> Furniture:
    """A plump cushion, lying."""
    return asset(
        "Cushion",
        [block(color, (size, size, 0.06)), block(color, (size * 0.9, size * 0.9, 0.05), (0, 0, 0.061), taper=0.6)],
    )


@cache
def chair(material: str, seat: str) -> Furniture:
    """A dining chair, 0.9 high; its seat reaches under a table."""
    legs = [block(material, (0.035, 0.035, 0.43), (x, -0.19, 0)) for x in (-0.19, 0.19)]
    posts = [block(material, (0.035, 0.035, 0.90), (x, 0.19, 0)) for x in (-0.19, 0.19)]
    slats = [block(material, (0.343, 0.02, 0.07), (0, 0.19, z)) for z in (0.6, 0.72, 0.82)]
    return asset("Chair", [*legs, *posts, block(seat, (0.43, 0.34, 0.03), (0, -0.005, 0.431)), *slats])


def _four_legs(material: str, width: float, depth: float, height: float, thick: float, inset: float) -> list[Solid]:
    return [
        block(material, (thick, thick, height), (x, y, 0))
        for x in (-width / 2 + inset, width / 2 - inset)
        for y in (-depth / 2 + inset, depth / 2 - inset)
    ]


@cache
def dining_table(length: float, material: str) -> Furniture:
    """A table for four to six."""
    depth, height = 0.9, 0.75
    parts = [
        block(material, (length, depth, 0.035), (0, 0, height - 0.035)),
        *_four_legs(material, length, depth, height - 0.036, 0.07, 0.08),
        *(block(material, (length - 0.24, 0.02, 0.06), (0, y, height - 0.096)) for y in (-0.36, 0.36)),
    ]
    return asset("Dining Table", parts, {"top": StandingSurface((0, 0, height), (length, depth))})


@cache
def coffee_table(width: float, depth: float, material: str) -> Furniture:
    """A low table with a shelf."""
    height = 0.42
    parts = [
        block(material, (width, depth, 0.03), (0, 0, height - 0.03)),
        *_four_legs(material, width, depth, height - 0.031, 0.05, 0.05),
        block(material, (width - 0.16, depth - 0.16, 0.02), (0, 0, 0.14)),
    ]
    shelf = StandingSurface((0, 0, 0.16), (width - 0.2, depth - 0.2), 0.21)
    return asset("Coffee Table", parts, {"top": StandingSurface((0, 0, height), (width, depth)), "shelf": shelf})


@cache
def side_table(size: float, material: str, round_top: bool) -> Furniture:
    """A small table for a lamp."""
    height = 0.55
    if round_top:
        plate = lathe(material, [(0, 0), (size / 2, 0), (size / 2, 0.025), (0, 0.025)], (0, 0, height - 0.025), 14)
        foot = lathe(material, [(0, 0), (size / 2.6, 0), (0.03, 0.03), (0, 0.03)], sides=12)
        parts = [plate, foot, rod(material, 0.025, (0, 0, 0.031), (0, 0, height - 0.026), 8)]
    else:
        top = block(material, (size, size, 0.025), (0, 0, height - 0.025))
        parts = [top, *_four_legs(material, size, size, height - 0.026, 0.04, 0.04)]
    room = size * (0.7 if round_top else 1.0)
    return asset("Side Table", parts, {"top": StandingSurface((0, 0, height), (room, room))})

"""The head end of an operating room: anaesthesia machine, monitors, infusions, airway."""

from __future__ import annotations

from functools import cache

import numpy as np

from .kit import Furniture, StandingSurface, asset, ball, block, lathe, rod


@cache
def anaesthesia_machine(width: float, height: float) -> Furniture:
    """Drawers, work surface, vaporisers, bellows and gauges."""
    depth = 0.72
    drawers = [
        block("white", (width - 0.28, 0.02, 0.17), (-0.11, -depth / 2 + 0.13, 0.17 + 0.19 * i)) for i in range(3)
    ]
    knobs = [block("grey", (0.16, 0.02, 0.02), (-0.11, -depth / 2 + 0.11, 0.28 + 0.19 * i)) for i in range(3)]
    vaporisers = [
        block(color, (0.10, 0.12, 0.20), (x, -0.09, 1.02)) for x, color in ((-0.22, "yellow"), (-0.08, "blue"))
    ]
    bellows = [rod("clear", 0.075, (width / 2 - 0.10, -0.12, 0.55), (width / 2 - 0.10, -0.12, 0.80), 10)]
    gauges = [
        rod("white", 0.035, (x, -0.03, height - 0.08), (x, -0.005, height - 0.08), 10) for x in (0.05, 0.15, 0.25)
    ]
    wheels = [
        rod("rubber", 0.05, (x - 0.02, y, 0.05), (x + 0.02, y, 0.05), 8)
        for x in (-width / 2 + 0.07, width / 2 - 0.07)
        for y in (-depth / 2 + 0.08, depth / 2 - 0.08)
    ]
    parts = [
        *wheels,
        block("grey", (width, depth, 0.05), (0, 0, 0.101)),
        block("plastic", (width - 0.2, depth - 0.15, 0.60), (-0.1, 0.06, 0.152)),
        block("plastic", (0.18, 0.30, 0.38), (width / 2 - 0.10, 0.1, 0.152)),
        block("steel", (width, depth, 0.03), (0, 0, 0.81)),
        block("plastic", (width, 0.34, height - 0.861), (0, 0.18, 0.841)),
        block("white", (width, 0.36, 0.02), (0, 0.18, height - 0.02)),
        block("screen", (0.24, 0.02, 0.16), (0.16, -0.005, 1.05)),
        *drawers,
        *knobs,
        *vaporisers,
        *bellows,
        *gauges,
    ]
    shelf = StandingSurface((0, -depth / 4 - 0.015, 0.84), (width - 0.04, depth / 2 - 0.07), 0.17)
    top = StandingSurface((0, 0.18, height), (width, 0.36))
    return asset("Anaesthesia Machine", parts, {"shelf": shelf, "top": top})


@cache
def monitor(width: float, kind: str) -> Furniture:
    """A flat screen on a foot: "patient" with curves, "desk" with windows."""
    height = round(width * 0.62, 3)
    low = 0.09
    screen = block("screen", (width - 0.03, 0.006, height - 0.03), (0, -0.034, low + 0.015))
    parts = [
        block("dark", (width * 0.45, 0.16, 0.015)),
        block("dark", (0.06, 0.03, low + 0.04), (0, 0.04, 0.016)),
        block("dark", (width, 0.05, height), (0, -0.005, low)),
        screen,
    ]
    if kind == "patient":
        parts += [
            block(color, (width * 0.6, 0.004, 0.012), (-width * 0.12, -0.040, low + height * share))
            for color, share in (("trace", 0.75), ("red", 0.52), ("yellow", 0.3))
        ]
    else:
        parts += [block("white", (width * 0.5, 0.004, height * 0.6), (-width * 0.1, -0.040, low + height * 0.2))]
    return asset("Monitor", parts)


@cache
def iv_pole(height: float) -> Furniture:
    """A pole on five feet with two hooks; ``hook`` surfaces are where bags hang."""
    feet = []
    for angle in np.radians(90 + 72 * np.arange(5)):
        x, y = 0.28 * np.cos(angle), 0.28 * np.sin(angle)
        feet += [rod("chrome", 0.014, (0.02 * np.cos(angle), 0.02 * np.sin(angle), 0.09), (x, y, 0.065), 6)]
        feet += [rod("rubber", 0.025, (x - 0.012, y, 0.026), (x + 0.012, y, 0.026), 8)]
    parts = [
        *feet,
        rod("chrome", 0.014, (0, 0, 0.06), (0, 0, height - 0.012), 6),
        block("chrome", (0.24, 0.012, 0.012), (0, 0, height - 0.013)),
        *(block("chrome", (0.008, 0.008, 0.03), (x, 0, height - 0.044)) for x in (-0.11, 0.11)),
    ]
    hooks = {
        name: StandingSurface((x, 0, height - 0.044), (0.01, 0.01)) for name, x in (("left", -0.11), ("right", 0.11))
    }
    return asset("IV Pole", parts, hooks)


@cache
def iv_bag(volume: str) -> Furniture:
    """An infusion bag ("large" or "small") with its drip chamber; it hangs by its top."""
    scale = 1.0 if volume == "large" else 0.8
    parts = [
        block("clear", (0.015, 0.01, 0.03), (0, 0, -0.03)),
        block("clear", (0.12 * scale, 0.045, 0.22 * scale), (0, 0, -0.031 - 0.22 * scale)),
        block("blue", (0.08 * scale, 0.05, 0.05), (0, 0, -0.17 * scale)),
        rod("clear", 0.012, (0, 0, -0.12 - 0.22 * scale), (0, 0, -0.032 - 0.22 * scale), 6),
    ]
    return asset("IV Bag", parts, origin="top")


@cache
def trolley(width: float, height: float, color: str) -> Furniture:
    """A drawer trolley with a work surface."""
    depth = 0.5
    wheels = [
        rod("rubber", 0.05, (x - 0.015, y, 0.05), (x + 0.015, y, 0.05), 8)
        for x in (-width / 2 + 0.07, width / 2 - 0.07)
        for y in (-depth / 2 + 0.07, depth / 2 - 0.07)
    ]
    step = (height - 0.18) / 4
    fronts = [
        block(color, (width - 0.08, 0.02, step - 0.02), (0, -depth / 2 + 0.012, 0.12 + step * i)) for i in range(4)
    ]
    parts = [
        *wheels,
        block("plastic", (width - 0.03, depth - 0.05, height - 0.134), (0, 0.02, 0.102)),
        block("grey", (width, depth, 0.03), (0, 0, height - 0.03)),
        *fronts,
        block("chrome", (0.02, depth * 0.8, 0.02), (width / 2 + 0.02, 0, height - 0.08)),
    ]
    return asset("Trolley", parts, {"top": StandingSurface((0, 0, height), (width, depth))})


@cache
def bag_mask() -> Furniture:
    """A resuscitation bag lying on its side: mask at -y, reservoir at +y."""
    parts = [
        ball("teal", (0.06, 0.085, 0.055), (0, 0.03, 0.056), 10, 5),
        rod("clear", 0.022, (0, -0.05, 0.045), (0, -0.085, 0.045), 8),
        rod("clear", 0.028, (0, -0.085, 0.045), (0, -0.13, 0.045), 10, 0.045),
        rod("clear", 0.016, (0, 0.11, 0.045), (0, 0.13, 0.045), 6),
    ]
    return asset("Bag Mask", parts)


@cache
def laryngoscope() -> Furniture:
    """Handle and blade, lying."""
    parts = [
        rod("chrome", 0.014, (0, 0.10, 0.014), (0, -0.02, 0.014), 8),
        block("chrome", (0.11, 0.014, 0.012), (0.05, -0.032, 0.008), taper=0.9),
    ]
    return asset("Laryngoscope", parts)


@cache
def tube(length: float) -> Furniture:
    """A breathing tube in its pack."""
    parts = [
        block("paper", (0.07, length, 0.003)),
        rod("clear", 0.006, (0.005, -length / 2 + 0.02, 0.0095), (-0.01, length / 2 - 0.04, 0.0095), 6),
        rod("blue", 0.009, (-0.01, length / 2 - 0.039, 0.0125), (-0.01, length / 2 - 0.015, 0.0125), 6),
    ]
    return asset("Tube", parts)


@cache
def medicine_vial(color: str) -> Furniture:
    """A glass vial with a coloured cap."""
    body = lathe("clear", [(0, 0), (0.013, 0), (0.013, 0.035), (0, 0.035)], sides=8)
    return asset("Vial", [body, rod(color, 0.010, (0, 0, 0.0352), (0, 0, 0.048), 8)])


@cache
def defibrillator() -> Furniture:
    """A defibrillator with its two paddles."""
    parts = [
        block("cream", (0.34, 0.26, 0.20)),
        block("screen", (0.16, 0.006, 0.10), (-0.06, -0.1335, 0.07)),
        block("red", (0.05, 0.006, 0.05), (0.10, -0.1335, 0.10)),
        *(block("dark", (0.09, 0.14, 0.06), (x, 0.02, 0.201)) for x in (-0.09, 0.09)),
    ]
    return asset("Defibrillator", parts)

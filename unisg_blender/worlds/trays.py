"""How instruments and supplies are laid out on trays and tables."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..geometry.planar import turned_reach
from .furniture import instruments as tools
from .furniture.kit import Furniture
from .layout import Layout, Placed, pick

Area = tuple[float, float, float, float]
WHOLE: Area = (0, 0, 1, 1)


def lay_row(
    layout: Layout, support: Placed, surface: str, assets: Sequence[Furniture], *, area: Area = WHOLE,
    tight: bool = False,
    handles_up: bool = True,
) -> list[Placed]:  # fmt: skip
    """Lay instruments side by side from left to right, parallel within some degrees, handles to the same side.

    ``area`` is the part of the surface to use, as shares (x from, y from, x to, y
    to). What finds no place any more is left out. Returns what lies there.
    """
    rng, top = layout.rng, support.asset.surfaces[surface]
    low, high = (np.array(area[:2]) - 0.5) * top.size, (np.array(area[2:]) - 0.5) * top.size
    lean = float(np.clip(rng.normal(0, 0.02), -0.05, 0.05))
    x, laid = low[0] + rng.uniform(0.005, 0.02), []
    for asset in assets:
        turn = lean + float(np.clip(rng.normal(0, 0.03), -0.1, 0.1))
        (left, near, _), (right, far, _) = asset.mesh.bounds
        reach_x, reach_y = turned_reach(np.array([right - left, far - near]) / 2, turn)
        slack = (high[1] - low[1]) / 2 - reach_y
        if slack < 0 or x + 2 * reach_x > high[0]:
            continue
        y = (low[1] + high[1]) / 2 + np.clip(rng.normal(0, 0.008), -slack, slack)
        pose = support.pose_at(
            top.center[0] + x + reach_x, top.center[1] + y, top.center[2], turn + (0.0 if handles_up else np.pi)
        )
        if layout.fits(asset, pose[None], support)[0]:
            laid.append(layout.add(asset, pose, support))
            x += 2 * reach_x + (rng.uniform(0.004, 0.012) if tight else rng.uniform(0.02, 0.05))
        else:
            x += 0.03
    return laid


def instrument_set(rng: np.random.Generator, count: int) -> list[Furniture]:
    """A set of instruments, alike ones beside each other, in an order that differs from set to set."""
    kinds = [tools.forceps(), tools.clamp(), tools.scissors(), tools.needle_holder(), tools.retractor()]
    shares = rng.dirichlet((2.0, 3.0, 1.5, 1.2, 1.2))
    counts = rng.multinomial(count, shares)
    order = rng.permutation(len(kinds))
    return [kinds[kind] for kind in order for _ in range(counts[kind])]


def instrument_tray(layout: Layout, support: Placed, surface: str, area: Area) -> Placed | None:
    """A tray, a little askew, with one row of instruments in it; often packed tightly."""
    rng = layout.rng
    shape = tools.tray(pick(rng, [0.42, 0.5]), pick(rng, [0.26, 0.3]))
    turn = pick(rng, [0, np.pi])
    tray = layout.place_on(shape, support, surface, yaw=turn, spread=0.03, area=area)
    if tray is not None:
        tight = bool(rng.random() < 0.5)
        count = int(rng.integers(8, 14)) if tight else int(rng.integers(4, 9))
        lay_row(layout, tray, "inside", instrument_set(rng, count), tight=tight, handles_up=bool(rng.random() < 0.8))
    return tray


def sharps_dish(layout: Layout, support: Placed, surface: str, area: Area) -> list[Placed]:
    """Scalpels apart from the rest, in a kidney dish; on the surface where no dish fits."""
    rng = layout.rng
    dish = layout.place_on(tools.kidney_dish(0.25), support, surface, yaw=pick(rng, [0, np.pi]), area=area)
    found = []
    for _ in range(int(rng.integers(1, 3))):
        if dish is None:
            scalpel = layout.place_on(tools.scalpel(), support, surface, yaw=0.0, area=area)
        else:
            scalpel = layout.place_on(tools.scalpel(), dish, "inside", yaw=np.pi / 2, spread=0.08, relation="inside")
        found += [scalpel] if scalpel else []
    return found


def swabs(layout: Layout, support: Placed, surface: str, area: Area, count: int) -> list[Placed]:
    """Swab stacks and single swabs near each other."""
    found = []
    for _ in range(count):
        kind = "stack" if layout.rng.random() < 0.6 else "folded"
        swab = layout.place_on(tools.swab(kind), support, surface, yaw=0.0, spread=0.15, area=area)
        found += [swab] if swab else []
    return found


def bowls(layout: Layout, support: Placed, surface: str, area: Area, count: int) -> None:
    """Steel bowls with fluids."""
    for _ in range(count):
        shape = tools.bowl(pick(layout.rng, [0.06, 0.08, 0.1]), pick(layout.rng, ["iodine", "clear"]))
        layout.place_on(shape, support, surface, area=area)


def syringes(layout: Layout, support: Placed, surface: str, area: Area, count: int) -> None:
    """Syringes in a row."""
    kinds = [tools.syringe(pick(layout.rng, [0.8, 1.0, 1.3])) for _ in range(count)]
    lay_row(layout, support, surface, kinds, area=area, tight=True)


def implants(layout: Layout, support: Placed, surface: str, area: Area) -> Placed | None:
    """An implant in its open box; returns the implant."""
    rng = layout.rng
    box = layout.place_on(tools.implant_box(0.2), support, surface, yaw=pick(rng, [0, np.pi]), area=area)
    where, level = (support, surface) if box is None else (box, "inside")
    relation = "on_top_of" if box is None else "inside"
    shape = tools.implant(pick(rng, [0.9, 1.0, 1.1]))
    return layout.place_on(
        shape, where, level, yaw=0.0, spread=0.3, relation=relation, area=area if box is None else WHOLE
    )

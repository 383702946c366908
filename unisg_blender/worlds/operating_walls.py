"""What stands and hangs along the walls of an operating room."""

from __future__ import annotations

import numpy as np

from .furniture import anaesthesia, building, storage, surgical
from .furniture import instruments as tools
from .furniture.kit import Furniture
from .layout import Layout, Placed, pick
from .operating_table_sides import STOOL_COLORS, hang_bags
from .shell import Side, against, beside_wall, mount

BOX_COLORS = ["blue", "green", "cream", "white", "teal"]


def along_the_walls(layout: Layout, floor: Placed, sides: list[Side]) -> None:
    """Cabinets, shelves, desk, bins and spare objects, big ones first; then what hangs on the walls."""
    rng = layout.rng
    much = sum(side.length for side in sides) / 28  # a longer wall holds more
    for _ in range(round(much * rng.integers(1, 4))):
        _cabinet(layout, floor, sides)
    _desk(layout, floor, sides)
    if rng.random() < 0.4:
        _to_wall(layout, floor, sides, storage.wash_basin(pick(rng, [0.7, 0.9])))
    for _ in range(round(much * rng.integers(0, 3))):
        _shelf(layout, floor, sides)
    for _ in range(round(much * rng.integers(0, 3))):
        _spare_trolley(layout, floor, sides)
    _bins(layout, floor, sides)
    _on_the_walls(layout, sides)
    _pushed_aside(layout, floor, sides, much)


def _on_the_walls(layout: Layout, sides: list[Side]) -> None:
    rng = layout.rng
    mount(layout, sides, building.supply_panel(pick(rng, [0.6, 0.8])), 1.3)
    mount(layout, sides, building.light_box(pick(rng, [0.8, 1.2])), pick(rng, [1.35, 1.45]))
    mount(layout, sides, building.wall_clock(0.16), 2.3)
    for _ in range(int(rng.integers(0, 3))):
        mount(layout, sides, building.glove_dispenser(pick(rng, [2, 3])), 1.2)


def _pushed_aside(layout: Layout, floor: Placed, sides: list[Side], much: float) -> None:
    """What nobody needs now: x-ray unit, hampers, stools, a pole, in any direction near the walls."""
    rng = layout.rng
    spare: list[Furniture] = []
    if rng.random() < 0.35:
        spare.append(surgical.c_arm(pick(rng, [0.75, 0.85])))
    spare += [storage.linen_hamper(pick(rng, ["gauze", "blue", "green"])) for _ in range(int(rng.integers(0, 3)))]
    stools = [
        storage.stool(pick(rng, [0.5, 0.6, 0.7]), pick(rng, STOOL_COLORS)) for _ in range(int(rng.integers(0, 3)))
    ]
    spare += [*stools, *([surgical.step_stool(0.2)] if rng.random() < 0.4 else [])]
    for asset in spare:
        layout.place(asset, lambda asset=asset: beside_wall(layout, sides, asset), floor)  # type: ignore[misc]
    for _ in range(round(much * rng.integers(0, 3))):
        pole = layout.place(
            anaesthesia.iv_pole(1.9), lambda: beside_wall(layout, sides, anaesthesia.iv_pole(1.9)), floor
        )
        if pole is not None and rng.random() < 0.3:
            hang_bags(layout, pole, 1)


def _to_wall(layout: Layout, floor: Placed, sides: list[Side], asset: Furniture) -> Placed | None:
    return layout.place(asset, lambda: against(layout, sides, asset), floor, tries=16)


def _cabinet(layout: Layout, floor: Placed, sides: list[Side]) -> None:
    rng = layout.rng
    width, height = pick(rng, [0.8, 0.9, 1.0]), pick(rng, [1.8, 2.0])
    shape = storage.cabinet(width, height, pick(rng, ["plastic", "teal", "cream"]), bool(rng.random() < 0.5))
    cabinet = _to_wall(layout, floor, sides, shape)
    if cabinet is not None:
        for _ in range(int(rng.integers(0, 3))):
            layout.place_on(_box(rng), cabinet, "top", yaw=0.0, spread=0.1)


def _box(rng: np.random.Generator) -> Furniture:
    return tools.supply_box(pick(rng, BOX_COLORS), pick(rng, [0.24, 0.3, 0.36]))


def _shelf(layout: Layout, floor: Placed, sides: list[Side]) -> None:
    rng = layout.rng
    shape = storage.shelf(pick(rng, [0.8, 1.0]), 1.8, 0.4, 4, "grey")
    shelf = _to_wall(layout, floor, sides, shape)
    if shelf is None:
        return
    for board in shape.surfaces:
        for _ in range(int(rng.integers(0, 4))):
            layout.place_on(_box(rng), shelf, board, yaw=0.0, spread=0.06, relation="inside")


def _desk(layout: Layout, floor: Placed, sides: list[Side]) -> None:
    """A desk with screen, keyboard and a stool before it."""
    rng = layout.rng
    desk = _to_wall(layout, floor, sides, storage.desk(pick(rng, [1.0, 1.2]), pick(rng, ["white", "birch"])))
    if desk is None:
        return
    layout.place_on(anaesthesia.monitor(0.5, "desk"), desk, "top", yaw=0.0, spread=0.08, area=(0.15, 0.6, 0.85, 1.0))
    layout.place_on(storage.keyboard(), desk, "top", yaw=0.0, spread=0.06, area=(0.1, 0.05, 0.9, 0.5))
    if rng.random() < 0.4:
        layout.place_on(_box(rng), desk, "top", yaw=0.0, spread=0.2)
    stool = storage.stool(pick(rng, [0.5, 0.55]), pick(rng, STOOL_COLORS))
    layout.place(
        stool,
        lambda: desk.pose_at(rng.normal(-0.15, 0.1), -0.3 - rng.uniform(0.05, 0.45), 0.0, rng.uniform(-np.pi, np.pi)),
        floor,
    )


def _spare_trolley(layout: Layout, floor: Placed, sides: list[Side]) -> None:
    rng = layout.rng
    color = pick(rng, ["blue", "teal", "grey", "red"])
    trolley = _to_wall(layout, floor, sides, anaesthesia.trolley(0.7, 0.9, color))
    if trolley is None:
        return
    if color == "red":
        layout.place_on(anaesthesia.defibrillator(), trolley, "top", yaw=0.0, spread=0.1)
    for _ in range(int(rng.integers(0, 3))):
        layout.place_on(_box(rng), trolley, "top", yaw=0.0, spread=0.2)


def _bins(layout: Layout, floor: Placed, sides: list[Side]) -> None:
    """Two or three bins side by side."""
    rng = layout.rng
    colors = rng.permutation(["yellow", "black", "blue"])[: int(rng.integers(2, 4))]
    height = pick(rng, [0.6, 0.7])
    first = _to_wall(layout, floor, sides, storage.waste_bin(str(colors[0]), height))
    if first is None:
        return
    ways = [-1, 1] if rng.random() < 0.5 else [1, -1]
    reach = {way: 0 for way in ways}
    for color in colors[1:]:
        shape = storage.waste_bin(str(color), height)
        for way in ways:
            x, y = way * (reach[way] + 1) * rng.uniform(0.43, 0.5), rng.normal(0, 0.02)
            pose = first.pose_at(x, y, 0.0, rng.normal(0, 0.04))
            if layout.fits(shape, pose[None], floor)[0]:
                layout.add(shape, pose, floor)
                reach[way] += 1
                break

"""The groups of a living room: seats before the television, and the dining table."""

from __future__ import annotations

import numpy as np

from .furniture import living, seating
from .furniture.building import WALL_THICKNESS
from .layout import Layout, Placed, facing, pick
from .shell import Side

SOFAS = ["fabric", "fabric_warm", "leather", "linen"]
WOODS = ["oak", "walnut", "birch"]
TEXTILES = ["wool", "wool_blue", "linen", "canvas"]


def television_group(layout: Layout, floor: Placed, sides: list[Side]) -> None:
    """Television against a wall, sofa opposite, coffee table between, chairs and lamps at the ends."""
    rng = layout.rng
    wood = pick(rng, WOODS)
    stand = _television(layout, floor, sides, wood)
    if stand is None:
        return
    sofa = _sofa(layout, floor, stand)
    if sofa is None:
        return
    table = _coffee_table(layout, floor, sofa, wood)
    if table is not None:
        _on_coffee_table(layout, table)
        _armchairs(layout, floor, table)
    _sofa_ends(layout, floor, sofa, wood)
    for _ in range(int(rng.integers(0, 4))):
        pillow = seating.cushion(pick(rng, [0.36, 0.4]), pick(rng, TEXTILES))
        layout.place_on(pillow, sofa, "seat", yaw=0.0, spread=0.25)


def _television(layout: Layout, floor: Placed, sides: list[Side], wood: str) -> Placed | None:
    """The stand in the middle part of a wall before which there is room for a sofa."""
    rng = layout.rng
    shape = living.television_stand(pick(rng, [1.2, 1.4, 1.6]), wood)
    for index in rng.permutation(len(sides)):
        side = sides[index]
        half = shape.size[0] / 2
        slack = side.length / 2 - half - 0.1
        if slack <= 0:
            continue
        y = -WALL_THICKNESS / 2 - shape.size[1] / 2
        for x in rng.normal(0, 0.35 * slack, 6):
            pose = side.wall.pose_at(
                float(np.clip(x, -slack, slack)), y - rng.uniform(0.01, 0.05), 0.0, rng.normal(0, 0.006)
            )
            ahead = layout.fits(seating.sofa(1.6, SOFAS[0]), _opposite(pose, np.array([2.3, 0.0, 0.0]))[None], floor)[0]
            if ahead and not side.blocked(float(x), half, 1.2) and layout.fits(shape, pose[None], floor)[0]:
                stand = layout.add(shape, pose, floor)
                screen = living.television(round(float(shape.size[0] * pick(rng, [0.7, 0.8, 0.85])), 2))
                layout.place_on(screen, stand, "top", yaw=0.0, spread=0.02)
                return stand
    return None


def _opposite(pose: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """A pose before another and facing it: (distance, sideways, turn)."""
    cos, sin = np.cos(pose[3]), np.sin(pose[3])
    distance, aside, turn = offset
    x, y = aside, -distance
    return np.array([pose[0] + cos * x - sin * y, pose[1] + sin * x + cos * y, 0.0, pose[3] + np.pi + turn])


def _sofa(layout: Layout, floor: Placed, stand: Placed) -> Placed | None:
    rng = layout.rng
    color = pick(rng, SOFAS)
    for width in rng.permutation([1.7, 2.0, 2.3]):
        shape = seating.sofa(float(width), color)
        found = layout.place(
            shape,
            lambda: _opposite(stand.pose, np.array([rng.uniform(2.3, 3.7), rng.normal(0, 0.15), rng.normal(0, 0.03)])),
            floor,
            clearance=0.02,
            tries=24,
        )
        if found is not None:
            return found
    return None


def _coffee_table(layout: Layout, floor: Placed, sofa: Placed, wood: str) -> Placed | None:
    """On a rug, where one fits, 35 to 50 cm before the sofa."""
    rng = layout.rng
    shape = seating.coffee_table(pick(rng, [0.9, 1.1]), pick(rng, [0.5, 0.6]), wood)
    edge = -sofa.asset.size[1] / 2

    def before() -> np.ndarray:
        """A place before the sofa."""
        y = edge - rng.uniform(0.37, 0.5) - shape.size[1] / 2
        return sofa.pose_at(float(np.clip(rng.normal(0, 0.08), -0.2, 0.2)), y, 0.0, rng.normal(0, 0.03))

    rug = None
    if rng.random() < 0.75:
        carpet = living.rug(2.0 if rng.random() < 0.6 else 1.7, pick(rng, [1.2, 1.4]), pick(rng, TEXTILES))
        rug = layout.place(
            carpet,
            lambda: sofa.pose_at(
                rng.normal(0, 0.05), edge - rng.uniform(0.06, 0.16) - carpet.size[1] / 2, 0.0, rng.normal(0, 0.02)
            ),
            floor,
        )
    if rug is None:
        return layout.place(shape, before, floor)
    level = rug.asset.surfaces["top"].center[2]
    return layout.place(shape, lambda: before() + np.array([0, 0, level, 0]), rug)


def _on_coffee_table(layout: Layout, table: Placed) -> None:
    rng = layout.rng
    layout.place_on(living.remote(), table, "top", spread=0.5, yaw=0.0)
    if rng.random() < 0.6:
        layout.place_on(living.fruit_bowl(pick(rng, [0.12, 0.15])), table, "top", area=(0.25, 0.2, 0.75, 0.8))
    for _ in range(int(rng.integers(0, 3))):
        layout.place_on(living.cup(pick(rng, ["white", "terracotta", "blue"])), table, "top")
    for _ in range(int(rng.integers(0, 3))):
        layout.place_on(_lying_book(rng), table, pick(rng, ["top", "shelf"]), yaw=0.0, spread=0.4)


def _lying_book(rng: np.random.Generator):  # type: ignore[no-untyped-def]
    color = pick(rng, ["blue", "red", "green", "cream", "walnut"])
    return living.book(pick(rng, [0.15, 0.21]), pick(rng, [0.22, 0.28]), pick(rng, [0.02, 0.035]), color)


def _armchairs(layout: Layout, floor: Placed, table: Placed) -> None:
    """None to two, beside the coffee table, turned to it."""
    rng = layout.rng
    color = pick(rng, SOFAS)
    for side in rng.permutation([-1, 1])[: int(rng.integers(0, 3))]:

        def beside(side: float = float(side)) -> np.ndarray:
            """A place beside the table, facing it."""
            x = side * (table.asset.size[0] / 2 + 0.43 + rng.uniform(0.25, 0.7))
            pose = table.pose_at(x, -rng.uniform(-0.25, 0.55), 0.0, 0.0)
            pose[2] = 0.0
            pose[3] = facing(pose, table.pose) + rng.normal(0, 0.15)
            return pose

        chair = layout.place(seating.armchair(color), beside, floor, clearance=0.04, tries=20)
        if chair is not None and rng.random() < 0.4:
            layout.place_on(seating.cushion(0.36, pick(rng, TEXTILES)), chair, "seat", yaw=0.0, spread=0.2)


def _sofa_ends(layout: Layout, floor: Placed, sofa: Placed, wood: str) -> None:
    """A side table with a lamp at one end, a floor lamp at the other."""
    rng = layout.rng
    ends = rng.permutation([-1, 1])
    if rng.random() < 0.8:
        shape = seating.side_table(pick(rng, [0.45, 0.5]), wood, bool(rng.random() < 0.5))
        table = layout.place(
            shape,
            lambda: sofa.pose_at(
                ends[0] * (sofa.asset.size[0] / 2 + shape.size[0] / 2 + rng.uniform(0.03, 0.12)),
                rng.uniform(-0.1, 0.2), 0.0, rng.normal(0, 0.04),
            ),
            floor,
        )  # fmt: skip
        if table is not None:
            layout.place_on(living.table_lamp(pick(rng, ["linen", "cream", "wool"])), table, "top")
            if rng.random() < 0.5:
                layout.place_on(_lying_book(rng), table, "top", yaw=0.0, spread=0.4)
    if rng.random() < 0.7:
        layout.place(
            living.floor_lamp(pick(rng, [1.5, 1.65]), pick(rng, ["linen", "cream"])),
            lambda: sofa.pose_at(
                ends[1] * (sofa.asset.size[0] / 2 + 0.22 + rng.uniform(0.03, 0.2)),
                rng.uniform(0.0, 0.3), 0.0, rng.uniform(-np.pi, np.pi),
            ),
            floor,
        )  # fmt: skip


def dining_group(layout: Layout, floor: Placed, sides: list[Side]) -> None:
    """A table with four to six chairs where there is room for one, laid or with a vase."""
    rng = layout.rng
    low, high = layout.outline.min(axis=0), layout.outline.max(axis=0)
    length = pick(rng, [1.2, 1.4, 1.6, 1.8])
    shape = seating.dining_table(length, pick(rng, WOODS))

    def somewhere() -> list[float]:
        """A place anywhere off the walls."""
        return [*rng.uniform(low + 0.9, high - 0.9), 0.0, rng.integers(2) * np.pi / 2 + rng.normal(0, 0.03)]

    table = layout.place(shape, somewhere, floor, clearance=0.42, tries=120)
    if table is None:
        return
    _chairs(layout, floor, table)
    if rng.random() < 0.6:
        layout.place_on(living.vase(pick(rng, [0.05, 0.06]), True), table, "top", area=(0.35, 0.3, 0.65, 0.7))
    for place in range(int(rng.integers(0, 5))):
        x, y = (-0.25, 0.25)[place % 2] * length, (-0.28, 0.28)[place // 2]
        pose = table.pose_at(x + rng.normal(0, 0.02), y + rng.normal(0, 0.01), 0.75, rng.uniform(-np.pi, np.pi))
        if layout.fits(living.plate(0.13), pose[None], table)[0]:
            layout.add(living.plate(0.13), pose, table)
    for _ in range(int(rng.integers(0, 3))):
        layout.place_on(living.cup(pick(rng, ["white", "blue"])), table, "top")


def _chairs(layout: Layout, floor: Placed, table: Placed) -> None:
    """Chairs face the table, their seats' front up to 15 cm under it; now and then one is pulled out."""
    rng = layout.rng
    shape = seating.chair(pick(rng, WOODS), pick(rng, ["linen", "fabric", "leather"]))
    length, depth = table.asset.size[0], table.asset.size[1]
    seats = [(x * length, side) for side in (-1, 1) for x in (-0.23, 0.23)]
    places = [(x, side * depth / 2, 0.0 if side > 0 else np.pi, side) for x, side in seats]
    spots = [table.pose_at(x, y + side * (0.21 - 0.08), 0.0, turn) for x, y, turn, side in places]
    if length > 1.5:
        spots += [table.pose_at(side * (length / 2 + 0.13), 0.0, 0.0, -side * np.pi / 2) for side in (-1, 1)]
    for spot in spots:
        out = np.array([-np.sin(spot[3]), np.cos(spot[3])])

        def seat(spot: np.ndarray = spot, out: np.ndarray = out) -> np.ndarray:
            """A place at the table, pushed in or pulled out."""
            pulled = rng.uniform(0.25, 0.5) if rng.random() < 0.15 else rng.uniform(-0.07, 0.08)
            at = spot[:2] + out * pulled + rng.normal(0, 0.015, 2)
            return np.array([*at, 0.0, spot[3] + rng.normal(0, 0.06 if pulled < 0.1 else 0.25)])

        layout.place(shape, seat, floor, tries=8)

"""The groups around an operating table: the sterile side, the head end, and what stands on the floor between."""

from __future__ import annotations

import numpy as np

from .furniture import anaesthesia, storage, surgical
from .furniture import instruments as tools
from .layout import Layout, Placed, facing, pick
from .trays import bowls, implants, instrument_set, instrument_tray, lay_row, sharps_dish, swabs, syringes

STOOL_COLORS = ["black", "teal", "blue"]


def sterile_side(layout: Layout, floor: Placed, table: Placed, side: float) -> None:
    """Mayo stand over the feet, instrument table behind the scrub nurse; ``side`` is the sign of the table's x."""
    mayo = _mayo_stand(layout, floor, table, side)
    back = _instrument_table(layout, floor, table, side)
    if mayo is not None:
        _furnish_mayo(layout, mayo)
    if back is not None:
        _furnish_instrument_table(layout, back)


def _mayo_stand(layout: Layout, floor: Placed, table: Placed, side: float) -> Placed | None:
    rng, length = layout.rng, table.asset.size[1]
    shape = surgical.mayo_stand(round(float(table.asset.size[2] + pick(rng, [0.30, 0.35, 0.40])), 2))

    def beside() -> np.ndarray:
        """A place with the tray over the patient's legs."""
        y = -length / 2 + rng.uniform(0.15, 0.75)
        return table.pose_at(side * rng.uniform(0.14, 0.5), y, 0.0, side * -np.pi / 2 + rng.normal(0, 0.08))

    return layout.place(shape, beside, floor, tries=24)


def _instrument_table(layout: Layout, floor: Placed, table: Placed, side: float) -> Placed | None:
    rng, length = layout.rng, table.asset.size[1]
    depth = pick(rng, [0.65, 0.75])
    shape = surgical.instrument_table(pick(rng, [1.3, 1.5, 1.6]), depth, pick(rng, [0.88, 0.92]))
    parallel = rng.random() < 0.7

    def behind() -> np.ndarray:
        """A place behind the scrub nurse, along the table or across its feet."""
        way = side if rng.random() < 0.85 else -side
        if parallel == (rng.random() < 0.9):
            x = way * (0.26 + rng.uniform(0.65, 1.3) + depth / 2)
            return table.pose_at(x, rng.uniform(-0.9, 0.1), 0.0, way * -np.pi / 2 + rng.normal(0, 0.04))
        y = -length / 2 - rng.uniform(0.6, 1.0) - depth / 2
        return table.pose_at(way * rng.uniform(0.0, 0.9), y, 0.0, np.pi + rng.normal(0, 0.04))

    return layout.place(shape, behind, floor, tries=80)


def _furnish_mayo(layout: Layout, mayo: Placed) -> None:
    """The instruments of the next minutes: one row, scalpels apart, a swab."""
    rng = layout.rng
    support, surface = mayo, "top"
    if rng.random() < 0.5:
        support = layout.add(surgical.drape(0.54, 0.34), mayo.pose_at(*mayo.asset.surfaces["top"].center, 0.0), mayo)
    flip = rng.random() < 0.5
    row, rest = ((0.30, 0, 1, 1), (0, 0, 0.28, 1)) if flip else ((0, 0, 0.70, 1), (0.72, 0, 1, 1))
    first = [tools.scalpel()] * int(rng.integers(1, 3)) + [tools.retractor(), tools.forceps()]
    assets = [*first, *instrument_set(rng, int(rng.integers(3, 9)))]
    lay_row(layout, support, surface, assets, area=row, tight=bool(rng.random() < 0.5))
    swabs(layout, support, surface, rest, int(rng.integers(1, 3)))


def _furnish_instrument_table(layout: Layout, back: Placed) -> None:
    """Trays on one side, sharps, implants and fluids on the other, each kind in its own corner."""
    rng = layout.rng
    support, surface = back, "top"
    if rng.random() < 0.8:
        size = np.subtract(back.asset.surfaces["top"].size, 0.04)
        cloth = surgical.drape(round(float(size[0]), 2), round(float(size[1]), 2))
        support = layout.add(cloth, back.pose_at(*back.asset.surfaces["top"].center, 0.0), back)
    mirror = bool(rng.random() < 0.5)

    def corner(x0: float, y0: float, x1: float, y1: float) -> tuple[float, float, float, float]:
        """The area of a corner, mirrored if the table is laid out so."""
        return (1 - x1, y0, 1 - x0, y1) if mirror else (x0, y0, x1, y1)

    instrument_tray(layout, support, surface, corner(0.0, 0.5, 0.42, 1.0))
    if rng.random() < 0.7:
        instrument_tray(layout, support, surface, corner(0.0, 0.0, 0.42, 0.5))
    else:
        lay_row(layout, support, surface, instrument_set(rng, 7), area=corner(0.02, 0.08, 0.42, 0.46))
    implants(layout, support, surface, corner(0.44, 0.6, 0.66, 1.0))
    sharps_dish(layout, support, surface, corner(0.44, 0.3, 0.68, 0.62))
    syringes(layout, support, surface, corner(0.44, 0.02, 0.72, 0.32), int(rng.integers(2, 5)))
    bowls(layout, support, surface, corner(0.72, 0.5, 1.0, 1.0), int(rng.integers(1, 3)))
    swabs(layout, support, surface, corner(0.74, 0.0, 1.0, 0.5), int(rng.integers(2, 5)))
    if rng.random() < 0.7:
        layout.place_on(
            tools.mallet(), support, surface, yaw=0.0, spread=0.2, area=corner(0.40, 0.0, 0.8, 1.0), tries=24
        )
    for _ in range(int(rng.integers(0, 3))):
        box = tools.supply_box(pick(rng, ["blue", "green", "cream"]), pick(rng, [0.24, 0.3]))
        layout.place_on(box, back, "shelf", yaw=0.0, spread=0.1)


def anaesthesia_side(layout: Layout, floor: Placed, table: Placed, side: float) -> None:
    """Machine with monitor, trolley, stool and infusions at the head end."""
    rng, length = layout.rng, table.asset.size[1]
    head = table.point(0, length / 2)
    shape = anaesthesia.anaesthesia_machine(pick(rng, [0.7, 0.75, 0.8]), pick(rng, [1.35, 1.45]))

    def at_head() -> np.ndarray:
        """A place at the head end, facing it."""
        x, y = rng.normal(side * 0.5, 0.25), length / 2 + rng.uniform(0.5, 0.85) + 0.36
        pose = table.pose_at(x, y, 0.0, 0.0)
        pose[3] = facing(pose, head) + rng.normal(0, 0.06)
        return pose

    machine = layout.place(shape, at_head, floor, tries=60)
    _iv_pole(layout, floor, table, -side)
    if machine is None:
        return
    layout.place_on(anaesthesia.monitor(pick(rng, [0.42, 0.5]), "patient"), machine, "top", yaw=0.0, spread=0.1)
    if rng.random() < 0.4:
        layout.place_on(anaesthesia.medicine_vial("red"), machine, "shelf", yaw=0.0)
    trolley = _trolley(layout, floor, machine, side)
    _airway(layout, machine, trolley)
    stool = storage.stool(pick(rng, [0.5, 0.55, 0.6]), pick(rng, STOOL_COLORS))
    layout.place(
        stool,
        lambda: table.pose_at(
            -side * rng.uniform(0.0, 0.6), length / 2 + rng.uniform(0.3, 0.8), 0.0, rng.uniform(-np.pi, np.pi)
        ),
        floor,
    )


def _iv_pole(layout: Layout, floor: Placed, table: Placed, side: float) -> None:
    rng, length = layout.rng, table.asset.size[1]
    pole = layout.place(
        anaesthesia.iv_pole(pick(rng, [1.8, 1.9, 2.0, 2.1])),
        lambda: table.pose_at(
            side * rng.uniform(0.5, 0.85), length / 2 - rng.uniform(-0.2, 0.5), 0.0, rng.uniform(-np.pi, np.pi)
        ),
        floor,
        tries=24,
    )
    if pole is not None:
        hang_bags(layout, pole, int(rng.integers(1, 3)))


def hang_bags(layout: Layout, pole: Placed, count: int) -> None:
    """Infusion bags on the hooks of a pole."""
    for hook in layout.rng.permutation(["left", "right"])[:count]:
        bag = anaesthesia.iv_bag(pick(layout.rng, ["large", "small"]))
        where = pole.asset.surfaces[str(hook)].center
        layout.place(bag, lambda: pole.pose_at(*where, layout.rng.normal(0, 0.3)), pole, relation="hangs_from")  # noqa: B023


def _trolley(layout: Layout, floor: Placed, machine: Placed, side: float) -> Placed | None:
    rng = layout.rng
    shape = anaesthesia.trolley(pick(rng, [0.7, 0.8]), pick(rng, [0.9, 0.95]), pick(rng, ["blue", "red", "teal"]))

    def beside() -> np.ndarray:
        """A place beside the machine."""
        way = side if rng.random() < 0.7 else -side
        x = way * (machine.asset.size[0] / 2 + shape.size[0] / 2 + rng.uniform(0.06, 0.35))
        return machine.pose_at(x, rng.uniform(-0.1, 0.3), 0.0, rng.normal(0, 0.12))

    return layout.place(shape, beside, floor, tries=24)


def _airway(layout: Layout, machine: Placed, trolley: Placed | None) -> None:
    """Bag mask and laryngoscope; on the machine's shelf or on the trolley, with tubes, syringes and vials."""
    rng = layout.rng
    places = [(machine, "shelf")] + ([(trolley, "top")] if trolley else [])
    objects = [anaesthesia.bag_mask(), anaesthesia.laryngoscope()]
    for obj in objects:
        order = rng.permutation(len(places)) if rng.random() < 0.4 else range(len(places))[::-1]
        for index in order:
            support, surface = places[index]
            if layout.place_on(obj, support, surface, yaw=pick(rng, [0, np.pi / 2, np.pi]), spread=0.2, tries=24):
                break
    if trolley is None:
        return
    lay_row(
        layout, trolley, "top", [anaesthesia.tube(0.3)] * int(rng.integers(1, 4)), area=(0.0, 0.2, 0.5, 1.0), tight=True
    )
    syringes(layout, trolley, "top", (0.5, 0.0, 1.0, 0.45), int(rng.integers(1, 4)))
    for _ in range(int(rng.integers(1, 5))):
        layout.place_on(
            anaesthesia.medicine_vial(pick(rng, ["red", "blue", "yellow"])), trolley, "top", area=(0.5, 0.4, 1.0, 1.0)
        )


def floor_around_table(layout: Layout, floor: Placed, table: Placed) -> None:
    """Electrosurgery and suction towards the feet, bucket, steps and a stool near the table."""
    rng, length = layout.rng, table.asset.size[1]
    feet = table.point(0, -length / 2)
    cart = surgical.electrosurgical_unit(pick(rng, [1.1, 1.2]))

    def off_the_feet() -> list[float]:
        """A place off the feet, facing the table."""
        angle, distance = table.pose[3] - np.pi / 2 + rng.uniform(-1.2, 1.2), rng.uniform(1.0, 2.0)
        at = feet[:2] + distance * np.array([np.cos(angle), np.sin(angle)])
        return [*at, 0.0, facing(at, table.pose) + rng.normal(0, 0.12)]

    unit = layout.place(cart, off_the_feet, floor, clearance=0.1, tries=24)
    near = unit or table

    def nearby() -> np.ndarray:
        """A place near the other unit, facing the table."""
        pose = near.pose_at(pick(rng, [-1, 1]) * rng.uniform(0.55, 1.1), rng.uniform(-0.2, 0.5), 0.0, 0.0)
        pose[3] = facing(pose, table.pose) + rng.normal(0, 0.2)
        return pose

    layout.place(surgical.suction_unit(pick(rng, [0.95, 1.05])), nearby, floor, clearance=0.05, tries=24)
    bucket = layout.place(
        surgical.kick_bucket(0.175),
        lambda: table.pose_at(
            pick(rng, [-1, 1]) * rng.uniform(0.5, 0.95), rng.uniform(-0.9, 0.3), 0.0, rng.uniform(-np.pi, np.pi)
        ),
        floor,
    )
    if bucket is not None and rng.random() < 0.5:
        layout.place_on(tools.swab("crumpled"), bucket, "inside", relation="inside")
    for _ in range(int(rng.integers(0, 3))):
        layout.place(
            surgical.step_stool(0.2),
            lambda: table.pose_at(
                pick(rng, [-1, 1]) * rng.uniform(0.55, 0.8), rng.uniform(-0.8, 0.3), 0.0,
                pick(rng, [-1, 1]) * np.pi / 2 + rng.normal(0, 0.1),
            ),
            floor,
        )  # fmt: skip

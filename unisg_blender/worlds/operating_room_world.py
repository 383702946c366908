"""Operating rooms: a knee is to be operated, everything stands where the people who work there want it."""

from __future__ import annotations

import numpy as np

from ..geometry.arrays import Floats
from ..scene.graph import SceneGraph
from .furniture import building, surgical
from .layout import Layout, Placed, facing, matrix_of, pick
from .operating_table_sides import anaesthesia_side, floor_around_table, sterile_side
from .operating_walls import along_the_walls
from .shell import Side, build_shell, cut_corner, keep_door_free, rectangle
from .surgery_lesson import surgery_lesson

HEIGHT = 3.0
RAIL_HEIGHT = 0.08


def operating_room(seed: int) -> SceneGraph:
    """An operating room before the incision.

    Rectangular, with a slanted or with a square corner cut off, 6-8 x 6-9 m. The
    same seed always gives the same room, bit for bit.

    Parameters
    ----------
    seed
        Any integer that is not negative; every one gives another room.
    """
    layout = furnish(seed)
    return layout.build(*surgery_lesson(layout))


def furnish(seed: int) -> Layout:
    """The room's objects, before they become a scenegraph."""
    rng = np.random.default_rng((seed, 1))
    layout = Layout(f"Operating Room {seed}", rng, _outline(rng))
    floor, sides = _shell(layout)
    keep_door_free(layout, sides)
    table = _operating_table(layout, floor)
    _patient(layout, table)
    _lamps(layout, sides, table)
    scrub = pick(rng, [-1, 1])
    sterile_side(layout, floor, table, scrub)
    anaesthesia_side(layout, floor, table, pick(rng, [-1, 1]))
    floor_around_table(layout, floor, table)
    width, length, _ = table.asset.size
    layout.keep_out((width + 1.8, length + 1.8, 2.0), table.pose)  # staff
    along_the_walls(layout, floor, sides)
    return layout


def _outline(rng: np.random.Generator) -> Floats:
    outline = rectangle(rng.integers(60, 81) / 10, rng.integers(60, 91) / 10)
    shape = rng.random()
    if shape < 0.4:
        return outline
    square = bool(shape > 0.78)
    x, y = rng.integers(8, 17, 2) / 10
    return cut_corner(outline, int(rng.integers(4)), x, y if square else x, square)


def _shell(layout: Layout) -> tuple[Placed, list[Side]]:
    rng = layout.rng
    lengths = np.linalg.norm(np.roll(layout.outline, -1, axis=0) - layout.outline, axis=1)
    edge = pick(rng, np.flatnonzero(lengths > 3.5).tolist())
    width, height = pick(rng, [1.5, 1.6, 1.8]), 2.1
    x = round(float(rng.uniform(-1, 1) * (lengths[edge] / 2 - width / 2 - 0.3)), 1)
    openings = {edge: ((x, 0.0, width, height), building.double_door(width, height))}
    return build_shell(layout, HEIGHT, "linoleum", pick(rng, ["tile", "plaster"]), openings)


def _operating_table(layout: Layout, floor: Placed) -> Placed:
    rng = layout.rng
    shape = surgical.operating_table(pick(rng, [1.95, 2.05, 2.1]), pick(rng, [0.75, 0.8, 0.85, 0.9]))
    middle = (layout.outline.min(axis=0) + layout.outline.max(axis=0)) / 2
    at = middle + np.clip(rng.normal(0, 0.25, 2), -0.5, 0.5)
    lean = rng.normal(0, 0.02)
    for quarter in rng.permutation(4):
        pose = np.array([*at, 0.0, quarter * np.pi / 2 + lean])
        if _room_for_people(layout, pose, shape.size[1]):
            break
    return layout.add(shape, pose, floor)


def _room_for_people(layout: Layout, pose: Floats, length: float) -> bool:
    """Is there room for anaesthesia at the head, and for instruments on both sides?"""
    turn = matrix_of(pose)
    zones = [((2.0, 1.4, 2.0), (0.0, length / 2 + 0.95))]
    zones += [((1.5, 1.6, 2.0), (side * 1.45, -0.4)) for side in (-1, 1)]
    return all(layout.is_clear(size, (*(turn[:2, :2] @ np.array(at) + pose[:2]), 0.05, pose[3])) for size, at in zones)


def _patient(layout: Layout, table: Placed) -> None:
    rng, top = layout.rng, table.asset.surfaces["top"]
    shape = surgical.patient(pick(rng, [1.6, 1.7, 1.75, 1.85]), pick(rng, [-1, 1]))
    y = top.size[1] / 2 - shape.size[1] / 2 - rng.uniform(0.04, 0.12)
    patient = layout.add(shape, table.pose_at(rng.normal(0, 0.01), y, top.center[2], rng.normal(0, 0.008)), table)
    site = shape.surfaces["knee"].center
    layout.add(surgical.knee(), patient.pose_at(*site, rng.normal(0, 0.02)), patient)


def _lamps(layout: Layout, sides: list[Side], table: Placed) -> None:
    """A girder from wall to wall above the table, and one or two lamps on it that shine on knee and trunk."""
    rng = layout.rng
    rail, along = _rail(layout, sides, table)
    top = HEIGHT - RAIL_HEIGHT
    patient, knee = layout.named("Patient")[0], layout.named("Knee")[0]
    targets = [knee.pose[:2], patient.point(0, 0.25)[:2]]
    signs = rng.permutation([-1.0, 1.0])
    for target, sign in list(zip(targets, signs, strict=True))[: int(rng.integers(1, 3))]:
        shape_reach = pick(rng, [0.6, 0.75, 0.9])
        drop = round(top - table.asset.size[2] - rng.uniform(1.0, 1.4), 1)

        def hang(target: Floats = target, sign: float = sign, reach: float = shape_reach) -> list[float]:
            """A place on the girder from which the lamp reaches its target."""
            aim = target + rng.normal(0, 0.08, 2)
            across = aim - rail.pose[:2] - along * ((aim - rail.pose[:2]) @ along)
            offset = np.sqrt(max(reach**2 - across @ across, 0.0))
            mount = aim - across + sign * offset * along
            return [*mount, top, facing(mount, aim)]

        shape = surgical.surgical_lamp(pick(rng, [0.3, 0.35]), drop, shape_reach)
        layout.place(shape, hang, rail, relation="hangs_from")


def _rail(layout: Layout, sides: list[Side], table: Placed) -> tuple[Placed, Floats]:
    """The girder, fixed to the wall at its end and a little beside the table's middle, and its direction."""
    rng = layout.rng
    axis, aside = int(rng.integers(2)), pick(rng, [-1, 1]) * rng.uniform(0.35, 0.5)
    for along in (np.eye(2)[axis], np.eye(2)[1 - axis]):
        point = table.pose[:2] + along[::-1] * aside
        (start, first), (stop, second) = (_wall_ahead(layout, sides, point, sign * along) for sign in (-1, 1))
        if start is not None and stop is not None:
            break
    slanted = 0.0 if start is not None and stop is not None else 0.08
    middle = point + along * (second - first) / 2
    shape = building.ceiling_rail(round(first + second - slanted - 0.001, 3))
    wall = start or stop
    return layout.add(shape, (*middle, HEIGHT - RAIL_HEIGHT, np.arctan2(along[1], along[0])), wall, "hangs_from"), along


def _wall_ahead(layout: Layout, sides: list[Side], point: Floats, way: Floats) -> tuple[Placed | None, float]:
    """The wall that one meets at a right angle going that way (None: at a slant), and how far it is."""
    best: tuple[Placed | None, float] = None, np.inf
    ends = np.roll(layout.outline, -1, axis=0)
    for side, a, b in zip(sides, layout.outline, ends, strict=True):
        edge = b - a
        across = way[0] * edge[1] - way[1] * edge[0]
        if abs(across) < 1e-9:
            continue
        distance = ((a[0] - point[0]) * edge[1] - (a[1] - point[1]) * edge[0]) / across
        place = ((a[0] - point[0]) * way[1] - (a[1] - point[1]) * way[0]) / across
        if distance > 0 and 0 <= place <= 1 and distance < best[1]:
            best = (side.wall if abs(edge @ way) < 1e-9 else None), float(distance)
    return best

"""Small scenes whose structure is known exactly: floors, outlines, rooms and openings are what was drawn."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from unisg_blender.geometry.planar import turn
from unisg_blender.geometry.polygon import area
from unisg_blender.scene import SceneBuilder, SceneGraph
from unisg_blender.spatial.structure import recognise_structure

from .built_rooms import (
    CORRIDOR,
    DOOR,
    FACES,
    L_SHAPE,
    ROUND,
    SQUARE,
    TRIANGLE,
    WINDOW,
    Hole,
    box,
    grown,
    joined,
    mesh,
    overlap,
    room,
    scene,
    slab,
    table,
    triangulated,
    walls,
)  # fmt: skip

PLAIN = (DOOR, WINDOW)
LAND = np.array([[-30, -30], [35, -30], [35, 34], [-30, 34]], float)


@dataclass(frozen=True, eq=False)
class Known:
    """A scene and its rooms, each outline and floor; how many doors and windows they have together; a hole in them.

    What is found must overlap by ``least`` (intersection over union), and its floor be as near as ``height`` metres.
    """

    graph: SceneGraph
    rooms: list[tuple[np.ndarray, float]]
    doors: int = 1
    windows: int = 1
    hole: np.ndarray | None = None
    least: float = 0.995
    height: float = 1e-3


def moved(outline: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    found = outline @ matrix[:2, :2].T + matrix[:2, 3]
    return found if area(found) > 0 else found[::-1]


def in_frame(matrix: np.ndarray, baked: bool, outline: np.ndarray = L_SHAPE) -> Known:
    graph = scene(room(outline, 0.1, holes=PLAIN), matrix, baked)
    return Known(graph, [(moved(outline, matrix), float(matrix[2, 3]))])


def at_angle(degrees: float) -> Known:
    matrix = turn(np.radians(degrees))
    matrix[:3, 3] = 3.0, -2.0, 0.2
    return in_frame(matrix, degrees % 10 == 0)


def in_unit(scale: float) -> Known:
    """Drawn in another unit, as a file brings it: a parent that scales."""
    builder = SceneBuilder("Built")
    top = builder.add("root", uid="root", local=np.diag([scale, scale, scale, 1.0]))
    for name, (points, faces) in room(L_SHAPE, 0.1, holes=PLAIN).items():
        builder.add(name, uid=name, parent=top, mesh=mesh((points / scale, faces)))
    return Known(builder.build(), [(L_SHAPE, 0.0)])


def y_up() -> Known:
    """Points with y up, under an object that turns them."""
    upright = np.eye(4)
    upright[:3, :3] = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    builder = SceneBuilder("Built")
    for name, (points, faces) in room(SQUARE, 0.2, holes=PLAIN).items():
        builder.add(name, uid=name, local=upright, mesh=mesh((points @ upright[:3, :3], faces)))
    return Known(builder.build(), [(SQUARE, 0.0)])


def instances() -> Known:
    """One wall four times, and a thing that is an instance of a collection: an Empty with meshes."""
    side, builder = mesh(box((-2.5, 0, 0), (2.5, 0.1, 2.5))), SceneBuilder("Built")
    square = np.array([[0, 0], [5, 0], [5, 5], [0, 5]], float)
    builder.add("ground", uid="ground", mesh=mesh(slab(square, -0.1, 0.0)))
    for number in range(4):
        matrix = turn(number * np.pi / 2)
        matrix[:2, 3] = np.array([2.5, 2.5]) + matrix[:2, :2] @ [0, 2.5]
        builder.add(f"side {number}", uid=f"side {number}", mesh=side, local=matrix)
    lamp = builder.add("lamp", uid="lamp", local=np.array([[1, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1, 0], [0, 0, 0, 1.0]]))
    builder.add("shade", uid="shade", parent=lamp, mesh=mesh(box((-0.2, -0.2, 1.4), (0.2, 0.2, 1.7))))
    builder.add("foot", uid="foot", parent=lamp, mesh=mesh(box((-0.05, -0.05, 0), (0.05, 0.05, 1.4))))
    return Known(builder.build(), [(square, 0.0)], 0, 0)


def furnished(one: str) -> Known:
    """Tables, a wardrobe on the wall, and frames that hang 2 cm off it."""
    objects = room(SQUARE, 0.1, one=one, holes=PLAIN)
    objects |= {"desk": table(1.5, 1.2, 0.0, 0.3), "wardrobe": box((3.8, 3.4, 0), (4.9, 3.98, 2.0))}
    objects |= {"frame": box((0.02, 1.5, 1.2), (0.05, 2.5, 1.9)), "screen": box((2, 3.93, 1.1), (3, 3.97, 1.7))}
    return Known(scene(objects), [(SQUARE, 0.0)])


def storeys() -> Known:
    lower = room(L_SHAPE, 0.2, one="all", holes=(DOOR,))["house"]
    upper = lower[0] + (0, 0, 2.7), lower[1]
    top = triangulated(grown(L_SHAPE, 0.3), 5.3)
    return Known(scene({"house": joined([lower, upper, top])}), [(L_SHAPE, 0.0), (L_SHAPE, 2.7)], 2, 0)


def several() -> Known:
    """Two rooms on a corridor in one mesh: the doors are seen from both sides."""
    left, right, long = SQUARE + np.array([0, 1.4]), SQUARE + np.array([5.2, 1.4]), CORRIDOR * [10.2 / 9, 1]
    parts = [*walls(long, 0, 2.5, 0.2, (Hole(2, 2.0, 2.9), Hole(2, 7.0, 7.9)))]
    parts += [*walls(left, 0, 2.5, 0.2)[1:], *walls(right, 0, 2.5, 0.2)[1:3]]
    ground = slab(grown(np.array([[0, 0], [10.2, 0], [10.2, 5.4], [0, 5.4]]), 0.2), -0.2, 0.0)
    return Known(scene({"ground": ground, "inside": joined(parts)}), [(left, 0), (right, 0), (long, 0)], 4, 0)


def open_plan() -> Known:
    """A beam over a passage as wide as the room, and a counter, part nothing."""
    whole = np.array([[0, 0], [9, 0], [9, 4], [0, 4]], float)
    objects = room(whole, 0.2, roof=True, holes=(DOOR,))
    objects |= {"beam": box((4.4, 0, 2.2), (4.6, 4, 2.5)), "counter": box((6, 0, 0), (6.6, 2.4, 0.9))}
    return Known(scene(objects), [(whole, 0.0)], 1, 0)


def under_a_slope() -> Known:
    """A pitched roof with its ridge along x, on purlins."""
    objects = room(SQUARE, 0.2, height=2.2, holes=(DOOR,))
    eaves, ridge = 2.2, 3.8
    corners = [[-0.4, -0.4, eaves], [5.4, -0.4, eaves], [5.4, 2, ridge], [-0.4, 2, ridge], [5.4, 4.4, eaves],
               [-0.4, 4.4, eaves]]  # fmt: skip
    objects["roof"] = np.array(corners), [[0, 1, 2, 3], [3, 2, 4, 5]]
    objects["purlin"] = box((0, 0.9, 2.6), (5, 1.0, 2.75))
    return Known(scene(objects), [(SQUARE, 0.0)], 1, 0)


def with_stairs() -> Known:
    """A flight of steps in a corner, up to a hole in the floor above."""
    lower = room(SQUARE, 0.2, one="all", holes=(DOOR,))["house"]
    steps = [box((4.0 - 0.25 * n, 3.0, 0), (4.25 - 0.25 * n, 4.0, 0.2 * (n + 1))) for n in range(12)]
    around = grown(SQUARE, 0.2)
    above = [slab(around * [1, 0] + [[0, -0.2], [0, -0.2], [0, 3], [0, 3]], 2.5, 2.7)]
    above += [slab(np.array([[4.25, 3], [5.2, 3], [5.2, 4.2], [4.25, 4.2]]), 2.5, 2.7)]
    sides = walls(SQUARE, 2.7, 5.2, 0.2)
    top = slab(around, 5.2, 5.3)
    upper = np.array([[0, 0], [5, 0], [5, 4], [4.25, 4], [4.25, 3], [0, 3]], float)
    rooms = [(SQUARE, 0.0), (upper, 2.7)]
    return Known(scene({"house": joined([lower, *steps, *above, *sides, top])}), rooms, 1, 0, least=0.985)


def terrace() -> Known:
    """A roofed room and a court behind it, on one floor, within one wall: the court is no room."""
    whole = np.array([[0, 0], [10, 0], [10, 4], [0, 4]], float)
    objects = room(whole, 0.2, holes=(DOOR,)) | {"roof": slab(grown(SQUARE, 0.0), 2.5, 2.6)}
    return Known(scene(objects), [(SQUARE, 0.0)], 1, 0)


def balcony() -> Known:
    """A slab before the room, under a roof, with a rail: no room."""
    objects = room(SQUARE, 0.2, roof=True, holes=(DOOR,))
    out = np.array([[0.5, -1.7], [3, -1.7], [3, -0.2], [0.5, -0.2]], float)
    objects |= {"slab": slab(out, -0.1, 0.0), "canopy": slab(out, 2.5, 2.6), "rail": box((0.5, -1.7, 0), (3, -1.65, 1))}
    return Known(scene(objects), [(SQUARE, 0.0)], 1, 0)


def holed() -> Known:
    """A court in the middle of a room, with walls around it."""
    outer = np.array([[0, 0], [9, 0], [9, 8], [0, 8]], float)
    court = np.array([[3, 3], [3, 5], [6, 5], [6, 3]], float)
    rim = [np.array(part, float) for part in ([[0, 0], [9, 0], [9, 3], [0, 3]], [[0, 5], [9, 5], [9, 8], [0, 8]],
           [[0, 3], [3, 3], [3, 5], [0, 5]], [[6, 3], [9, 3], [9, 5], [6, 5]])]  # fmt: skip
    parts = [*(slab(part, -0.1, 0.0) for part in rim), *walls(outer, 0, 2.5, 0.1, (DOOR,)), *walls(court, 0, 2.5, 0.1)]
    return Known(scene({"house": joined(parts)}), [(outer, 0.0)], 1, 0, court)


def inward() -> Known:
    """A room as a cube whose faces look inwards."""
    cube = box((0, 0, 0), (5, 4, 2.5))
    return Known(scene({"cube": (cube[0], [face[::-1] for face in FACES])}), [(SQUARE, 0.0)], 0, 0)


def outward() -> Known:
    """The same with its faces turned out, and a table in it."""
    return Known(scene({"cube": box((0, 0, 0), (5, 4, 2.5)), "desk": table(2, 2, 0)}), [(SQUARE, 0.0)], 0, 0)


def flipped_floor() -> Known:
    """Floor and walls are sheets that look away from the room."""
    objects = {"floor": (slab(SQUARE, 0.0, 0.0)[0], [[3, 2, 1, 0]]), "sides": joined(walls(SQUARE, 0, 2.5, 0.0, PLAIN))}
    return Known(scene(objects), [(SQUARE, 0.0)])


def on_land(make: Callable[[], dict]) -> Known:
    return Known(scene(make() | {"land": slab(LAND, -1.0, -0.3)}), [(L_SHAPE, 0.0)])


def plane_for_all() -> Known:
    """No floor of its own: a plane under everything, walls without lintels."""
    doorway = Hole(0, 1.0, 1.9, 0.0, 2.5)
    objects = {"plane": slab(LAND, 0.0, 0.0), "sides": joined(walls(SQUARE, 0, 2.5, 0.2, (doorway,)))}
    return Known(scene(objects), [(SQUARE, 0.0)], 0, 0, least=0.99)


def shop() -> Known:
    """One long wall is not there."""
    outline = np.array([[0, 0], [12, 0], [12, 9], [0, 9]], float)
    parts = dict(zip("abc", walls(outline, 0, 3, 0.2)[1:], strict=True)) | {"floor": slab(outline, -0.1, 0.0)}
    return Known(scene(parts), [(outline, 0.0)], 0, 0)


def parapet() -> Known:
    """A loggia on a plane: three walls, and a parapet of 0.9 m on the fourth side."""
    objects = {"plane": slab(LAND, 0.0, 0.0), "sides": joined(walls(SQUARE, 0, 2.5, 0.2)[1:])}
    objects["parapet"] = box((0, -0.2, 0), (5, 0, 0.9))
    return Known(scene(objects), [(SQUARE, 0.0)], 0, 1)


def uneven() -> Known:
    """A threshold, a rug and a floor that is not quite level are one floor."""
    points, faces = slab(SQUARE, -0.1, 0.0)
    tilted = points + np.array([0, 0, 0.01]) * points[:, :1]
    objects = {"floor": (tilted, faces), "sides": joined(walls(SQUARE, 0, 2.5, 0.1, PLAIN))}
    return Known(scene(objects | {"rug": box((1, 1, 0), (3, 2.5, 0.05))}), [(SQUARE, 0.02)], height=0.02)


def far_away() -> Known:
    matrix = np.eye(4)
    matrix[:3, 3] = 12_000, -8_000, 300
    return replace(in_frame(matrix, baked=False), height=0.02)


KNOWN: dict[str, Callable[[], Known]] = {
    **{f"turned by {degrees}": lambda degrees=degrees: at_angle(degrees) for degrees in range(0, 91, 5)},
    "centimetres": lambda: in_unit(0.01),
    "inches": lambda: in_unit(0.0254),
    "y up": y_up,
    "triangle": lambda: Known(scene(room(TRIANGLE, 0.1, holes=PLAIN)), [(TRIANGLE, 0.0)]),
    "round": lambda: Known(scene(room(ROUND, 0.1)), [(ROUND, 0.0)], 0, 0, least=0.99),
    "corridor": lambda: Known(scene(room(CORRIDOR, 0.1, holes=(DOOR,))), [(CORRIDOR, 0.0)], 1, 0),
    "one mesh": lambda: Known(scene(room(L_SHAPE, 0.1, one="all", holes=PLAIN)), [(L_SHAPE, 0.0)]),
    "walls in one mesh": lambda: Known(scene(room(L_SHAPE, 0.1, one="walls", holes=PLAIN)), [(L_SHAPE, 0.0)]),
    "one-sided walls": lambda: Known(scene(room(L_SHAPE, 0.0, holes=PLAIN)), [(L_SHAPE, 0.0)]),
    "thick walls": lambda: Known(scene(room(L_SHAPE, 0.4, holes=PLAIN)), [(L_SHAPE, 0.0)]),
    "instances": instances,
    "mirrored": lambda: in_frame(np.diag([-1.0, 1, 1, 1]), baked=False),
    "unapplied scale": lambda: in_frame(np.diag([1.5, 1.2, 1.1, 1]), baked=False),
    "far from the origin": far_away,
    "furniture, frames off the wall": lambda: furnished(""),
    "furniture, walls in one mesh": lambda: furnished("walls"),
    "storeys": storeys,
    "several rooms": several,
    "open plan": open_plan,
    "under a slope": under_a_slope,
    "stairs": with_stairs,
    "terrace": terrace,
    "balcony": balcony,
    "court in the middle": holed,
    "cube, faces inwards": inward,
    "cube, faces outwards": outward,
    "sheets that look away": flipped_floor,
    "house on land": lambda: on_land(lambda: room(L_SHAPE, 0.2, one="all", holes=PLAIN)),
    "plane for all": plane_for_all,
    "shop without a front": shop,
    "parapet": parapet,
    "uneven floor": uneven,
}


@pytest.mark.parametrize("name", KNOWN)
def test_structure_is_what_was_drawn(name: str) -> None:
    known = KNOWN[name]()
    structure = recognise_structure(known.graph)
    inside = [found for found in structure.rooms if found.indoors]
    assert len(inside) == len(known.rooms)
    for outline, floor in known.rooms:
        truth = (outline,) if known.hole is None else (outline, known.hole)
        near = [found for found in inside if abs(found.floor - floor) < 0.06]
        shares = [overlap((found.outline, *found.holes), truth) for found in near]
        found = near[int(np.argmax(shares))]
        assert max(shares) >= known.least
        assert found.floor == pytest.approx(floor, abs=known.height)
    kinds = [opening.kind for found in inside for opening in found.openings]
    assert (kinds.count("door"), kinds.count("window")) == (known.doors, known.windows)

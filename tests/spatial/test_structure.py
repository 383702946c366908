"""Structure from geometry: rooms of known shape are found in every form in which users have them."""

from __future__ import annotations

import numpy as np
import pytest

from unisg_blender.geometry.planar import turn
from unisg_blender.geometry.polygon import area
from unisg_blender.scene import SceneBuilder
from unisg_blender.spatial.structure import recognise_structure
from unisg_blender.spatial.structure.room_things import things_in_rooms
from unisg_blender.spatial.structure.structure_text import structure_lines, structure_record

from .built_rooms import (
    CORRIDOR,
    DOOR,
    FACES,
    L_SHAPE,
    OUTLINES,
    SQUARE,
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
    walls,
)  # fmt: skip


def shapes(structure):
    return [(found.outline, *found.holes) for found in structure.rooms]


def only(structure, outline, floor=0.0, least=0.99):
    """The structure's only room, which has this outline."""
    assert len(structure.rooms) == 1, structure.notes
    found = structure.rooms[0]
    assert found.indoors
    assert found.floor == pytest.approx(floor, abs=1e-4)
    assert overlap((found.outline, *found.holes), (outline,)) >= least
    return found


def moved(outline, matrix):
    return outline @ matrix[:2, :2].T + matrix[:2, 3]


@pytest.mark.parametrize("shape", OUTLINES)
@pytest.mark.parametrize("one", ["", "walls", "all"])
@pytest.mark.parametrize("thickness", [0.0, 0.05, 0.1, 0.3])
def test_rooms_of_every_shape_and_make(shape, one, thickness) -> None:
    outline, round_one = OUTLINES[shape], shape == "round"
    holes = () if round_one else (DOOR,)
    found = only(
        recognise_structure(scene(room(outline, thickness, one=one, holes=holes))),
        outline,
        least=0.98 if round_one else 0.99,
    )
    assert area(found.outline) == pytest.approx(area(outline), rel=0.03 if round_one else 0.01)
    assert len([wall for wall in found.walls if wall.length > 0.5]) >= (16 if round_one else len(outline))
    assert all(wall.thickness == pytest.approx(thickness, abs=0.06 if round_one else 1e-3) for wall in found.walls)
    assert [opening.kind for opening in found.openings] == ["door"] * len(holes)


ANGLES = [
    degrees if degrees % 20 == 0 else pytest.param(degrees, marks=pytest.mark.slow) for degrees in range(0, 91, 5)
]


@pytest.mark.parametrize("degrees", ANGLES)
def test_rooms_at_any_angle_are_exact(degrees) -> None:
    matrix = turn(np.radians(degrees))
    matrix[:3, 3] = 7.3, -2.1, 0.4
    for baked in (True, False):
        structure = recognise_structure(scene(room(L_SHAPE, 0.1, holes=(DOOR, WINDOW)), matrix, baked))
        found = only(structure, moved(L_SHAPE, matrix), 0.4)
        assert area(found.outline) == pytest.approx(area(L_SHAPE), rel=2e-3)
        assert sorted(opening.kind for opening in found.openings) == ["door", "window"]


def test_doors_and_windows_are_where_they_were_cut() -> None:
    found = only(recognise_structure(scene(room(SQUARE, 0.2, roof=True, holes=(DOOR, WINDOW)))), SQUARE)
    door, window = sorted(found.openings, key=lambda opening: opening.kind)
    assert (door.kind, window.kind) == ("door", "window")
    np.testing.assert_allclose([door.start, door.stop], [[1.0, 0], [1.9, 0]], atol=0.06)
    np.testing.assert_allclose([window.start, window.stop], [[5, 1.0], [5, 2.2]], atol=0.06)
    assert door.bottom == 0
    for opening in (door, window):  # up to the first cut that meets the wall over it
        assert 2.0 <= opening.top <= 2.4
    assert 0.9 <= window.bottom <= 1.3
    assert found.ceiling == pytest.approx(2.5)


def test_openings_up_to_the_top_do_not_let_the_room_out() -> None:
    found = only(
        recognise_structure(scene(room(SQUARE, 0.2, holes=(Hole(0, 1.0, 1.9, 0.0, 2.5),)))), SQUARE, least=0.98
    )
    assert len(found.walls) >= 4


@pytest.mark.parametrize(
    "matrix",
    [np.diag([-1.0, 1, 1, 1]), np.diag([1.0, -1, 1, 1]), np.diag([1.5, 1.2, 1.1, 1])],
    ids=["mirrored x", "mirrored y", "scaled"],
)
@pytest.mark.parametrize("baked", [True, False])
def test_mirrored_and_scaled_rooms(matrix, baked) -> None:
    outline = moved(L_SHAPE, matrix)
    outline = outline if area(outline) > 0 else outline[::-1]
    only(recognise_structure(scene(room(L_SHAPE, 0.1), matrix, baked)), outline)


def test_a_room_far_from_the_origin() -> None:
    matrix = np.eye(4)
    matrix[:3, 3] = 5e5, 5.4e6, 300
    found = recognise_structure(scene(room(SQUARE, 0.1), matrix, baked=False)).rooms
    assert len(found) == 1
    assert overlap((found[0].outline - matrix[:2, 3],), (SQUARE,)) >= 0.97  # points are single precision


def test_several_rooms_and_a_corridor() -> None:
    """Two rooms on a corridor: five walls are shared, doors lead out of each."""
    left, right = SQUARE + np.array([0, 1.4]), SQUARE + np.array([5.2, 1.4])
    long = CORRIDOR * [10.2 / 9, 1]
    ground = slab(grown(np.array([[0, 0], [10.2, 0], [10.2, 5.4], [0, 5.4]]), 0.2), -0.2, 0.0)
    parts = [*walls(long, 0, 2.5, 0.2, (Hole(2, 2.0, 2.9), Hole(2, 7.0, 7.9)))]
    parts += [*walls(left, 0, 2.5, 0.2)[1:], *walls(right, 0, 2.5, 0.2)[1:3]]
    structure = recognise_structure(scene({"ground": ground, "inside": joined(parts)}))
    truth = sorted([left, right, long], key=area, reverse=True)
    assert len(structure.rooms) == 3
    for found in structure.rooms:
        assert max(overlap((found.outline, *found.holes), (shape,)) for shape in truth) >= 0.98
    assert sorted(sum(o.kind == "door" for o in found.openings) for found in structure.rooms) == [1, 1, 2]


def test_things_are_told_by_room() -> None:
    """A bed left, a desk and a lamp (under an Empty) right; what stands outside is in none."""
    left, away = room(SQUARE, 0.2), np.array([5.2, 0, 0])
    parts = left | {f"right {name}": (points + away, faces) for name, (points, faces) in left.items()}
    builder = SceneBuilder("Built")
    for name, part in (parts | {"bed": box((1, 1, 0), (3, 2.5, 0.5)), "desk": table(7, 2, 0), "bin": box(
        (-2, 0, 0), (-1.7, 0.3, 0.4))}).items():  # fmt: skip
        builder.add(name, uid=name, mesh=mesh(part))
    top = builder.add("top", uid="top")
    builder.add("lamp", uid="lamp", parent=top, mesh=mesh(box((8, 3, 0), (8.1, 3.1, 1.7))))
    graph = builder.build()
    structure = recognise_structure(graph)
    told = {
        round(float(found.outline[:, 0].mean())): sorted(graph.name[row] for row in rows)
        for found, rows in zip(structure.rooms, things_in_rooms(structure, graph), strict=True)
    }
    assert told == {2: ["bed"], 8: ["desk", "lamp"]}
    record = structure_record(structure, graph)
    assert sorted(name for part in record["rooms"] for name in part["things"]) == ["bed", "desk", "lamp"]
    assert any("with bed" in line for line in structure_lines(structure, graph))


def test_two_storeys_of_one_mesh() -> None:
    lower = room(SQUARE, 0.2, one="all", holes=(DOOR,))["house"]
    upper = lower[0] + (0, 0, 2.6), lower[1]
    top = slab(grown(SQUARE, 0.5), 5.1, 5.2)
    structure = recognise_structure(scene({"house": joined([lower, upper, top])}))
    assert structure.storeys == 2
    assert [(found.storey, round(found.floor, 2), round(found.ceiling, 2)) for found in structure.rooms] == [
        (0, 0.0, 2.5), (1, 2.6, 5.1),
    ]  # fmt: skip
    assert all(overlap(shape, (SQUARE,)) >= 0.98 for shape in shapes(structure))
    assert structure.parts == {0: ("Floor", "Wall", "Ceiling")}


def test_eaves_and_the_ground_around_are_outside() -> None:
    ground = slab(np.array([[-20, -20], [25, -20], [25, 24], [-20, 24]], float), -0.2, -0.05)
    objects = room(SQUARE, 0.2, holes=(DOOR,)) | {"roof": slab(grown(SQUARE, 0.8), 2.5, 2.6), "terrain": ground}
    only(recognise_structure(scene(objects)), SQUARE, least=0.98)


def test_a_terrace_beside_a_roofed_room_is_outside() -> None:
    """One floor, one wall around both; half of it has a roof, and a skylight in that."""
    whole = np.array([[0, 0], [10, 0], [10, 4], [0, 4]], float)
    roof = [slab(np.array(part, float), 2.5, 2.6) for part in (
        [[0, 0], [2, 0], [2, 4], [0, 4]], [[2, 0], [3, 0], [3, 1], [2, 1]], [[2, 2], [3, 2], [3, 4], [2, 4]],
        [[3, 0], [5, 0], [5, 4], [3, 4]],
    )]  # fmt: skip
    structure = recognise_structure(scene(room(whole, 0.2) | {"roof": joined(roof)}))
    inner, outer = sorted(structure.rooms, key=lambda found: not found.indoors)
    assert (inner.indoors, outer.indoors) == (True, False)
    assert overlap((inner.outline,), (SQUARE,)) >= 0.98
    assert overlap((outer.outline,), (SQUARE + np.array([5, 0]),)) >= 0.98


def test_a_beam_across_a_room_without_a_ceiling_is_no_roof() -> None:
    whole = np.array([[0, 0], [10, 0], [10, 6], [0, 6]], float)
    beam = slab(np.array([[4, 0], [4.8, 0], [4.8, 6], [4, 6]], float), 2.0, 2.2)
    only(recognise_structure(scene(room(whole, 0.2) | {"beam": beam})), whole)


@pytest.mark.parametrize("land", [False, True])
def test_a_side_of_glass_to_the_floor_is_no_end_of_the_room(land) -> None:
    """A shop of 12 x 9 m without a ceiling, one long wall of which is not there; land around it is no part of it."""
    shop = np.array([[0, 0], [12, 0], [12, 9], [0, 9]], float)
    parts = dict(zip("abc", walls(shop, 0, 3, 0.2)[1:], strict=True)) | {"floor": slab(shop, -0.1, 0.0)}
    if land:
        parts["land"] = slab(np.array([[-60, -60], [60, -60], [60, 60], [-60, 60]], float), -1.1, -0.6)
    (found,) = recognise_structure(scene(parts)).rooms
    assert found.indoors
    assert area(found.outline) == pytest.approx(108, rel=0.01)


def test_tables_are_surfaces_and_no_floors() -> None:
    objects = room(SQUARE, 0.1, roof=True)
    objects["desk"] = table(1.5, 1.5, 0.0, 0.4)
    graph = scene(objects)
    structure = recognise_structure(graph)
    only(structure, SQUARE)
    tops = [surface for surface in structure.surfaces if surface.area > 0.5]
    assert [(graph.name[top.row], round(top.height, 3), top.room) for top in tops] == [("desk", 0.75, 0)]
    assert tops[0].area == pytest.approx(0.96, rel=0.1)
    assert tops[0].headroom == pytest.approx(1.75)
    merged = recognise_structure(scene({"house": joined(list(objects.values()))}))
    only(merged, SQUARE)
    assert [round(surface.height, 3) for surface in merged.surfaces if surface.area > 0.5] == [0.75]


def test_the_floor_under_a_wardrobe_is_no_room() -> None:
    objects = room(SQUARE, 0.1) | {"wardrobe": box((1, 1, 0.05), (3, 2.5, 2.1))}
    structure = recognise_structure(scene(objects))
    only(structure, SQUARE)
    stage = recognise_structure(scene({"floor": slab(SQUARE, -0.1, 0.0), "wardrobe": box((1, 1, 0.05), (3, 2.5, 2.1))}))
    assert [found.indoors for found in stage.rooms] == [False]


def test_instances_are_walls_too() -> None:
    side = mesh(box((-2.5, 0, 0), (2.5, 0.1, 2.5)))
    builder = SceneBuilder("Built")
    builder.add("ground", uid="ground", mesh=mesh(slab(SQUARE[:, :1] * 0 + SQUARE * [1, 1.25], -0.1, 0.0)))
    for number in range(4):
        builder.add(f"side {number}", uid=f"side {number}", mesh=side, local=_around(number))
    only(recognise_structure(builder.build()), SQUARE * [1, 1.25])


def _around(number: int) -> np.ndarray:
    """The matrix of one of four walls around a square of 5 m."""
    matrix = turn(number * np.pi / 2)
    matrix[:2, 3] = np.array([2.5, 2.5]) + matrix[:2, :2] @ [0, 2.5]
    return matrix


def test_the_category_of_the_user_wins() -> None:
    builder = SceneBuilder("Built")
    parts = room(SQUARE, 0.1)
    builder.add("dais", uid="dais", category="Floor", mesh=mesh(slab(SQUARE * 0.5, 0.0, 0.3)))
    for name, part in parts.items():
        builder.add(name, uid=name, mesh=mesh(part))
    builder.add("block", uid="block", category="Cabinet", mesh=mesh(box((3, 0, 0), (3.2, 4, 2.4))))
    found = recognise_structure(builder.build()).rooms
    assert [(round(part.floor, 2), round(part.area, 1)) for part in found] == [(0.3, 5.0)]


def test_what_is_no_room_is_said() -> None:
    assert "no faces" in recognise_structure(SceneBuilder("Empty").build()).notes[0]
    assert "a thing" in recognise_structure(scene({"chair": box((0, 0, 0), (0.4, 0.4, 0.9))})).notes[0]
    side = np.linspace(-50, 50, 41)
    x, y = (part.ravel() for part in np.meshgrid(side, side))
    quads = [[41 * j + i, 41 * j + i + 1, 41 * j + i + 42, 41 * j + i + 41] for j in range(40) for i in range(40)]
    hills = np.column_stack([x, y, 8 * np.sin(x / 9) * np.cos(y / 7)]), quads
    structure = recognise_structure(scene({"hills": hills}))
    assert structure.rooms == ()
    assert "no floor was found" in structure.notes[0]
    stage = recognise_structure(scene({"stage": slab(SQUARE, -0.1, 0.0)}))
    assert [found.indoors for found in stage.rooms] == [False]
    assert overlap(shapes(stage)[0], (SQUARE,)) >= 0.99
    assert "no walls" in stage.notes[0]


def test_a_small_house_on_wide_land_is_seen_finely() -> None:
    land = slab(np.array([[-600, -600], [600, -600], [600, 600], [-600, 600]], float), -1.0, -0.3)
    structure = recognise_structure(scene(room(L_SHAPE, 0.2, roof=True, holes=(DOOR,)) | {"land": land}))
    only(structure, L_SHAPE, least=0.97)
    assert structure.cell == pytest.approx(0.05)


def test_a_room_drawn_as_a_cube_from_outside() -> None:
    """Its floor looks down and its ceiling up: things in it tell that it is hollow."""
    cube = box((0, 0, 0), (5, 4, 2.5))
    only(recognise_structure(scene({"cube": cube, "desk": table(2, 2, 0)})), SQUARE)
    assert [found.floor for found in recognise_structure(scene({"block": cube})).rooms] == [2.5]  # one stands on top
    inward = cube[0], [face[::-1] for face in FACES]
    only(recognise_structure(scene({"cube": inward})), SQUARE)

"""What stands on what, and beside what, as artists leave it: sunk in, on sheets and hills, turned, close together."""

from __future__ import annotations

import numpy as np
import pytest

from unisg_blender.errors import UniSGError
from unisg_blender.geometry.polygon import convex_gap, convex_hull
from unisg_blender.geometry.surface_contact import surface_gap
from unisg_blender.scene import Mesh, SceneBuilder, mesh_from_faces
from unisg_blender.spatial import find_relations, find_supports
from unisg_blender.spatial.objects import find_object

FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def block(low, high, inside_out: bool = False) -> Mesh:
    points = [[(low, high)[i][0], (low, high)[j][1], (low, high)[k][2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    return mesh_from_faces("Block", np.array(points, float), [face[::-1] if inside_out else face for face in FACES])


def sheet(size: float = 9.0) -> Mesh:
    points = np.array([(-size, -size, 0), (size, -size, 0), (size, size, 0), (-size, size, 0)], float)
    return mesh_from_faces("Sheet", points, [[0, 1, 2, 3]])


GROUNDS = {"flat": sheet(), "thick": block((-9, -9, -1), (9, 9, 0)), "slab": block((-9, -9, -0.05), (9, 9, 0))}


def at(x: float = 0.0, y: float = 0.0, z: float = 0.0, yaw: float = 0.0) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:2, :2] = [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
    matrix[:3, 3] = x, y, z
    return matrix


def scene(**objects):
    builder = SceneBuilder("Room")
    for name, (mesh, local) in objects.items():
        builder.add(name, uid=name, mesh=mesh, local=local)
    return builder.build()


def told(graph):
    return {(graph.name[one], kind, graph.name[two]) for one, kind, two in find_relations(graph)}


def held(graph):
    found = find_supports(graph)
    return {graph.name[row]: graph.name[on] for row, on in zip(found.row, found.on, strict=True)}


@pytest.mark.parametrize("inside_out", [False, True])
@pytest.mark.parametrize("ground", GROUNDS)
@pytest.mark.parametrize("sunk", [0.0, 5e-9, -5e-9, 0.002, 0.005, 0.008, 0.015, 0.03, 0.1, 0.3])
def test_a_crate_sunk_into_the_ground_stands_on_it(ground, sunk, inside_out) -> None:
    crate = block((0, 0, 0), (1, 1, 1.3), inside_out)
    graph = scene(ground=(GROUNDS[ground], at()), crate=(crate, at(2, 1, -sunk, 0.4)))
    assert told(graph) == {("crate", "on_top_of", "ground")}
    assert held(graph) == {"crate": "ground"}


def test_what_goes_through_the_ground_below_its_middle_only_stands_on_it() -> None:
    graph = scene(ground=(sheet(), at()), post=(block((0, 0, 0), (0.1, 0.1, 2)), at(0, 0, -1.5)))
    assert told(graph) == {("ground", "connected_to", "post"), ("post", "connected_to", "ground")}
    assert held(graph) == {}


def test_what_stands_in_something_narrower_does_not_stand_on_it() -> None:
    """A broad cupboard pushed 5 cm into a low one beside it: both stand on the floor."""
    graph = scene(
        floor=(sheet(), at()),
        tall=(block((0, 0, 0), (1, 0.6, 2)), at()),
        low=(block((0.95, 0, 0), (2.2, 0.6, 0.8)), at()),
    )
    assert {entry for entry in told(graph) if entry[1] == "on_top_of"} == {
        ("tall", "on_top_of", "floor"), ("low", "on_top_of", "floor"),
    }  # fmt: skip
    assert ("tall", "connected_to", "low") in told(graph)


def test_the_legs_of_a_chair_may_be_sunk() -> None:
    legs = [block((x, y, 0), (x + 0.04, y + 0.04, 0.45)) for x in (0, 0.36) for y in (0, 0.36)]
    parts = [*legs, block((0, 0, 0.45), (0.4, 0.4, 0.48)), block((0, 0, 0.48), (0.4, 0.03, 0.9))]
    faces = [[corner + 8 * number for corner in face] for number in range(len(parts)) for face in FACES]
    chair = mesh_from_faces("Chair", np.concatenate([part.points for part in parts]), faces)
    graph = scene(floor=(sheet(), at()), chair=(chair, at(1, 1, -0.04)))
    assert told(graph) == {("chair", "on_top_of", "floor")}
    assert held(graph) == {"chair": "floor"}


def test_things_stand_on_hills_and_in_houses_of_one_mesh() -> None:
    side = np.linspace(-5, 5, 11)
    x, y = (part.ravel() for part in np.meshgrid(side, side))
    quads = [[11 * j + i, 11 * j + i + 1, 11 * j + i + 12, 11 * j + i + 11] for j in range(10) for i in range(10)]
    hill = mesh_from_faces("Hill", np.column_stack([x, y, 3 - 0.1 * (x**2 + y**2)]), quads)
    assert held(scene(hill=(hill, at()), hut=(block((0, 0, 0), (1, 1, 1)), at(2, 0, 2.3)))) == {"hut": "hill"}
    shell = [block((-4, -4, -0.2), (4, 4, 0)), block((-4, -4, 0), (-3.8, 4, 3)), block((-4, -4, 3), (4, 4, 3.2))]
    faces = [[corner + 8 * number for corner in face] for number in range(3) for face in FACES]
    house = mesh_from_faces("House", np.concatenate([part.points for part in shell]), faces)
    graph = scene(
        house=(house, at()), bed=(block((0, 0, 0), (1, 2, 0.5)), at()), box=(block((0, 0, 0), (1, 1, 1)), at(1))
    )
    assert held(graph) == {"bed": "house", "box": "house"}


def test_turned_neighbours_whose_world_boxes_overlap_are_beside_each_other() -> None:
    cube = block((-0.5, -0.5, 0), (0.5, 0.5, 1))
    turned = mesh_from_faces("Turned", cube.points @ at(yaw=np.pi / 4)[:3, :3].T, FACES)  # turned in its points
    for mesh, yaw in ((cube, np.pi / 4), (turned, 0.0)):
        for gap, near in ((0.06, True), (0.153, True), (0.7, False)):
            shift = (1 + gap) / np.sqrt(2)
            found = told(scene(left=(mesh, at(yaw=yaw)), right=(mesh, at(shift, shift, 0, yaw))))
            assert (("left", "beside", "right") in found) == near
            assert (("left", "left_of", "right") in found) == near


def test_gaps_of_footprints() -> None:
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], float)
    assert convex_gap(square, square + np.array([1.5, 0])) == pytest.approx(0.5)
    assert convex_gap(square, square + np.array([2, 2])) == pytest.approx(np.sqrt(2))
    assert convex_gap(square, square + 0.5) == 0
    assert convex_gap(square, square / 4 + 0.3) == 0
    inner = np.concatenate([square, [[0.5, 0.5], [0.2, 0.9]]])
    assert sorted(convex_hull(inner).tolist()) == sorted(square.tolist())
    assert len(convex_hull(np.array([[0, 0], [1, 1], [2, 2.0]]))) == 2


def test_surfaces_that_cross_have_no_gap() -> None:
    floor = sheet().points[sheet().triangles].astype(float)
    upright = np.array([[[0, 0, -1], [1, 0, 2], [0, 1, 2]]], float)
    assert surface_gap(floor, upright) == surface_gap(upright, floor) == 0
    assert surface_gap(floor, upright + np.array([0, 0, 1.5])) == pytest.approx(0.5)


def test_an_object_that_is_none_of_those_asked_about_is_told() -> None:
    """A ceiling is an object of the scene, but none of those that hold something."""
    graph = scene(Roof=(block((0, 0, 0), (1, 1, 1)), at()))
    assert find_object(graph, graph.uid, "Roof") == 0
    with pytest.raises(UniSGError, match="holds nothing"):
        find_object(graph, (), "Roof")

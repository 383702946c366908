"""Relations from geometry: on known arrangements, under any turn of the scene, and on rooms whose truth is known."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unisg_blender.scene import Mesh, SceneBuilder, SceneGraph, mesh_from_faces
from unisg_blender.spatial.relation_tolerances import RelationTolerances
from unisg_blender.spatial.relations import KINDS, find_relations, relate
from unisg_blender.worlds import cubes, living_room, operating_room

DEFAULT = RelationTolerances()
FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def block(low: tuple[float, ...], high: tuple[float, ...]) -> Mesh:
    corners = [
        [(low, high)[x][0], (low, high)[y][1], (low, high)[z][2]] for x in (0, 1) for y in (0, 1) for z in (0, 1)
    ]
    return mesh_from_faces("Block", np.array(corners, float), FACES)


def joined(*meshes: Mesh) -> Mesh:
    """Several meshes as one."""
    shift = np.cumsum([0, *(len(mesh.points) for mesh in meshes)])
    faces = [(mesh.corners.reshape(-1, 4) + start).tolist() for mesh, start in zip(meshes, shift, strict=False)]
    return mesh_from_faces(
        "Joined", np.concatenate([mesh.points for mesh in meshes]), [face for part in faces for face in part]
    )


CUBE = block((-0.5, -0.5, 0), (0.5, 0.5, 1))
TABLE = joined(
    block((-1, -1, 0.7), (1, 1, 0.75)),
    *(block((x - 0.05, y - 0.05, 0), (x + 0.05, y + 0.05, 0.7)) for x in (-0.9, 0.9) for y in (-0.9, 0.9)),
)
BOWL = joined(
    block((-0.2, -0.2, 0), (0.2, 0.2, 0.01)),
    block((-0.2, -0.2, 0), (-0.19, 0.2, 0.15)), block((0.19, -0.2, 0), (0.2, 0.2, 0.15)),
    block((-0.2, -0.2, 0), (0.2, -0.19, 0.15)), block((-0.2, 0.19, 0), (0.2, 0.2, 0.15)),
)  # fmt: skip
SMALL = block((-0.04, -0.04, 0), (0.04, 0.04, 0.08))


def placed(x: float, y: float, z: float, angle: float = 0.0) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    matrix[:3, 3] = x, y, z
    return matrix


def scene(**objects: tuple[Mesh, np.ndarray]) -> SceneGraph:
    builder = SceneBuilder("Room")
    for name, (mesh, local) in objects.items():
        builder.add(name, uid=name, mesh=mesh, local=local)
    return builder.build()


def told(graph: SceneGraph, tolerances: RelationTolerances = DEFAULT) -> set[tuple[str, str, str]]:
    return {(graph.name[one], kind, graph.name[two]) for one, kind, two in find_relations(graph, tolerances)}


def test_on_top_and_its_tolerances() -> None:
    for gap, stands in ((0.0, True), (0.005, True), (-0.01, True), (0.05, False), (-0.2, False)):
        found = told(scene(low=(CUBE, placed(0, 0, 0)), high=(SMALL, placed(0.1, 0, 1 + gap))))
        assert (("high", "on_top_of", "low") in found) == stands, gap
        assert ("low", "on_top_of", "high") not in found
    found = told(scene(low=(CUBE, placed(0, 0, 0)), high=(SMALL, placed(0, 0, 1.05))), RelationTolerances(gap=0.06))
    assert ("high", "on_top_of", "low") in found


def test_under_a_table_is_not_on_it() -> None:
    """An object between the legs is in the table's box, but neither on nor in the table."""
    found = told(scene(table=(TABLE, np.eye(4)), ball=(SMALL, placed(0, 0, 0)), cup=(SMALL, placed(0.5, 0, 0.75))))
    assert ("cup", "on_top_of", "table") in found
    assert not {kind for one, kind, two in found if (one, two) == ("ball", "table")} & {"on_top_of", "inside"}


@pytest.mark.parametrize("sunk", [0.0, 1e-6, 0.005])
@pytest.mark.parametrize("size", [2.0, 12.5, 50.0])
def test_the_ground_is_not_on_what_pierces_it(size: float, sunk: float) -> None:
    """Legs that reach a little through a plane had it on top of them, where their lower sides look up."""
    corners = size * np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    plane = mesh_from_faces("Ground", corners, [[0, 1, 2, 3]])
    cube = mesh_from_faces("Cube", CUBE.points, [*FACES[:4], [4, 6, 2, 0], FACES[5]])
    one, two = (cube, placed(0, 0, -sunk)), (cube, placed(size / 2, 0, -sunk))
    found = told(scene(ground=(plane, np.eye(4)), one=one, two=two))
    assert {entry for entry in found if entry[1] == "on_top_of"} == {
        (name, "on_top_of", "ground") for name in ("one", "two")
    }


def test_a_backdrop_is_on_nothing() -> None:
    """A shell around all stands on the base of the room by its corners, but is no object on top of it."""
    base = block((-4, -4, -0.5), (4, 4, 0))
    for size, stands in ((15.0, False), (6.0, True)):
        shell = block((-size, -size, 0), (size, size, 2 * size))
        found = told(scene(base=(base, np.eye(4)), shell=(shell, np.eye(4)), table=(TABLE, np.eye(4))))
        assert (("shell", "on_top_of", "base") in found) == stands


def test_inside_a_bowl_on_a_table() -> None:
    found = told(scene(table=(TABLE, np.eye(4)), bowl=(BOWL, placed(0, 0, 0.75)), apple=(SMALL, placed(0.02, 0, 0.76))))
    assert ("apple", "inside", "bowl") in found
    assert ("bowl", "on_top_of", "table") in found
    assert ("apple", "on_top_of", "table") not in found


@pytest.mark.parametrize("past", [(0.3, 0.0), (-0.3, 0.0), (0.0, 0.3), (0.0, -0.3)])
def test_what_reaches_out_of_a_bowl_is_not_inside(past: tuple[float, float]) -> None:
    """One side of its box lies beyond the bowl's, its middle does not."""
    low = (min(past[0], -0.02), min(past[1], -0.02), 0.02)
    ladle = block(low, (max(past[0], 0.02), max(past[1], 0.02), 0.06))
    bowl = (BOWL, placed(0, 0, 0))
    assert ("ladle", "inside", "bowl") not in told(scene(bowl=bowl, ladle=(ladle, placed(0, 0, 0))))
    spoon = mesh_from_faces("Spoon", ladle.points * [0.4, 0.4, 1], FACES)
    assert ("spoon", "inside", "bowl") in told(scene(bowl=bowl, spoon=(spoon, placed(0, 0, 0))))


def test_above_and_below() -> None:
    found = told(scene(low=(CUBE, placed(0, 0, 0)), high=(CUBE, placed(0.2, 0, 2.5)), far=(CUBE, placed(0, 0, 9))))
    assert {("high", "above", "low"), ("low", "below", "high")} <= found
    assert not any("far" in (one, two) for one, _, two in found)


def test_beside_left_and_front() -> None:
    graph = scene(middle=(CUBE, placed(0, 0, 0)), right=(CUBE, placed(1.3, 0, 0)), back=(CUBE, placed(0, 1.2, 0)))
    assert told(graph) >= {
        ("middle", "left_of", "right"), ("right", "right_of", "middle"), ("right", "beside", "middle"),
        ("middle", "in_front_of", "back"), ("back", "behind", "middle"), ("back", "beside", "middle"),
    }  # fmt: skip
    turned = told(graph, RelationTolerances(heading=np.pi))
    assert {("right", "left_of", "middle"), ("back", "in_front_of", "middle")} <= turned


def test_connected_and_part_of() -> None:
    found = told(scene(one=(CUBE, placed(0, 0, 0)), two=(CUBE, placed(1.0, 0, 0.3))))
    assert {("one", "connected_to", "two"), ("two", "connected_to", "one")} <= found
    builder = SceneBuilder("Room")
    door = builder.add("Door", uid="door", mesh=CUBE, category="Door")
    builder.add("Handle", uid="handle", parent=door, mesh=SMALL, local=placed(0.54, 0, 0.5))
    knob = builder.add("Sign", uid="sign", parent=door, mesh=SMALL, local=placed(-0.54, 0, 0.5), category="Sign")
    assert knob
    assert {("Handle", "part_of", "Door"), ("Sign", "part_of", "Door")} <= told(builder.build())


def test_relations_of_users_stay_and_go_through_the_graph() -> None:
    from unisg_blender.scene import table

    graph = scene(low=(CUBE, placed(0, 0, 0)), high=(SMALL, placed(0, 0, 1)))
    graph = graph.with_component("relations", table([0, 0], kind=["belongs to", "inside"], target=["low", "low"]))
    found = relate(relate(graph)).components["relations"]
    assert sorted(zip(found.columns["kind"], found.columns["target"], strict=True)) == [
        ("belongs to", "low"), ("on_top_of", "low"),
    ]  # fmt: skip


def test_nothing_and_broken_geometry() -> None:
    assert find_relations(SceneBuilder("Empty").build()) == []
    bad = mesh_from_faces("Bad", np.full((4, 3), np.nan), [[0, 1, 2, 3]])
    flat = mesh_from_faces("Flat", np.zeros((4, 3)), [[0, 1, 2, 3]])
    squeezed = np.diag([0.0, 0.0, 0.0, 1.0])
    found = told(scene(bad=(bad, placed(9, 9, 9)), flat=(flat, placed(5, 5, 5)), cube=(CUBE, squeezed)))
    assert not any(kind in ("on_top_of", "inside") for _, kind, _ in found)


@given(
    angle=st.floats(-3, 3), shift=st.tuples(*[st.floats(-50, 50)] * 3), offset=st.tuples(*[st.floats(-0.4, 0.4)] * 2)
)
@settings(max_examples=40, deadline=None)
def test_any_turn_about_the_vertical(angle: float, shift: tuple[float, ...], offset: tuple[float, ...]) -> None:
    """Support does not depend on where the scene is and how it is turned about Z."""
    stage = placed(*shift, angle)
    graph = scene(
        low=(CUBE, stage), high=(SMALL, stage @ placed(*offset, 1.0, angle)), side=(SMALL, stage @ placed(0.6, 0, 0.5))
    )
    found = {entry for entry in told(graph) if entry[1] in ("on_top_of", "inside")}
    assert found == {("high", "on_top_of", "low")}


@pytest.mark.parametrize(
    ("world", "precision", "recall"), [(cubes, 1.0, 1.0), (living_room, 0.97, 0.97), (operating_room, 0.97, 0.97)]
)
def test_rooms_whose_truth_is_known(world: object, precision: float, recall: float) -> None:
    """Of "on top of" and "inside"; walls, which stand beside the floor's edge, and doors in walls apart."""
    hits = claims = truths = 0
    for seed in range(2):
        graph = world(seed)
        stored = graph.components["relations"]
        kinds = ("on_top_of", "inside")
        truth = {
            (int(row), kind, graph.row_of_uid[uid])
            for row, kind, uid in zip(stored.rows, stored.columns["kind"], stored.columns["target"], strict=True)
            if kind in kinds and graph.category_name(int(row)) not in ("Wall", "Door")
        }
        found = {entry for entry in find_relations(graph) if entry[1] in kinds}
        hits, claims, truths = hits + len(found & truth), claims + len(found), truths + len(truth)
    assert hits / claims >= precision
    assert hits / truths >= recall


def test_kinds_are_legal_names() -> None:
    assert all(kind.isidentifier() for kind in KINDS)

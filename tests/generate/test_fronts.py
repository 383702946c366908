"""Chairs face tables and sofas look into the room, whichever side of the user's mesh is the front."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from tests.meshes.shapes import box
from tests.words.foreign_scenes import builder
from unisg_blender.dataset.assets.asset import Asset
from unisg_blender.generate import Generator
from unisg_blender.generate.observe.facing import facing, front_first
from unisg_blender.geometry.planar import rotation, turn
from unisg_blender.pretrained import find_generator
from unisg_blender.scene import Mesh, SceneBuilder, SceneGraph, mesh_from_faces
from unisg_blender.spatial.fronts import SIDES, front_of
from unisg_blender.spatial.objects import scene_objects
from unisg_blender.worlds import living_room, operating_room

QUARTER = np.pi / 2


def joined(*meshes: Mesh) -> Mesh:
    points = np.concatenate([mesh.points for mesh in meshes])
    starts = np.cumsum([0, *(len(mesh.points) for mesh in meshes)])
    faces = [mesh.triangles + start for mesh, start in zip(meshes, starts, strict=False)]
    return mesh_from_faces("made", points, np.concatenate(faces))


def chair(turns: int = 0) -> Mesh:
    """A chair with its back at +y, turned by quarters: its front is ``SIDES[turns]``."""
    legs = [box((0.04, 0.04, 0.45), (x, y, 0)) for x in (-0.22, 0.18) for y in (-0.22, 0.18)]
    whole = joined(
        box((0.45, 0.45, 0.05), (-0.225, -0.225, 0.43)), box((0.45, 0.04, 0.5), (-0.225, 0.185, 0.45)), *legs
    )
    return replace(whole, points=(whole.points @ rotation(turns * QUARTER).T).astype(np.float32))


def sofa(turns: int = 0) -> Mesh:
    whole = joined(
        box((2.0, 0.9, 0.42), (-1, -0.45, 0)), box((2.0, 0.2, 0.4), (-1, 0.25, 0.4)),
        box((0.2, 0.7, 0.2), (-1, -0.45, 0.4)), box((0.2, 0.7, 0.2), (0.8, -0.45, 0.4)),
    )  # fmt: skip
    return replace(whole, points=(whole.points @ rotation(turns * QUARTER).T).astype(np.float32))


def parlour(make: Callable[[int], Mesh], turns: int, name: str) -> SceneGraph:
    """A room with a dining table and one thing of the user's, in a corner: it stands the same however it is stored."""
    made = builder("parlour")
    made.add("Esstisch", uid="t", mesh=box((1.6, 0.9, 0.75), (1.7, 1.5, 0)))
    corner = turn(-turns * QUARTER)
    corner[:3, 3] = 3.9, 3.5, 0
    made.add(name, uid="own", mesh=make(turns), local=corner)
    return made.build()


def outline_of(made, uid: str) -> np.ndarray:
    graph = made.scene
    row = graph.row_of_uid[uid]
    points = graph.meshes[graph.mesh[row]].points @ graph.world[row, :3, :3].T + graph.world[row, :3, 3]
    return points[np.lexsort(np.round(points, 3).T)]


@pytest.fixture(scope="module")
def generator() -> Generator:
    return Generator.load(find_generator("living_room"))


@pytest.mark.parametrize("make", [chair, sofa])
@pytest.mark.parametrize("turns", range(4))
def test_the_front_is_told_in_every_turn(make, turns: int) -> None:
    mesh = make(turns)
    front = front_of(mesh.points.astype(float)[mesh.triangles])
    assert front.told
    assert SIDES[front.side] == SIDES[turns]


def test_what_has_no_front_is_not_told() -> None:
    for mesh in (box((0.5, 0.5, 0.7), (-0.25, -0.25, 0)), box((1.0, 1.0, 0.02))):
        assert not front_of(mesh.points.astype(float)[mesh.triangles]).told
    assert not front_of(np.zeros((0, 3, 3))).told
    sheet = box((1.0, 0.0, 0.7))
    assert not front_of(sheet.points.astype(float)[sheet.triangles]).told


@pytest.mark.parametrize("turns", [1, 2, 3])
@pytest.mark.parametrize("seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (1, 2))])
def test_chairs_face_the_table_whichever_side_is_their_front(generator: Generator, turns: int, seed: int) -> None:
    plain, turned = (generator.add(parlour(chair, t, "Stuhl"), {"Chair": 3}, seed) for t in (0, turns))
    for one, two in zip(plain.objects, turned.objects, strict=True):
        assert one.refused == two.refused
        if not one.refused:
            np.testing.assert_allclose(outline_of(plain, one.uid), outline_of(turned, two.uid), atol=2e-3)


@pytest.mark.parametrize("turns", [1, 2, 3])
def test_a_sofa_looks_into_the_room(generator: Generator, turns: int) -> None:
    made = generator.add(parlour(sofa, turns, "Couch"), {"Sofa": 1}, 4)
    (item,) = made.objects
    if item.refused:
        pytest.skip("no room for it")
    front = item.world[:3, :3] @ rotation(turns * QUARTER) @ np.array([0.0, -1.0, 0.0])
    assert front[:2] @ (np.array([2.5, 2.0]) - item.world[:2, 3]) > 0


def test_an_asset_is_turned_and_stays_as_large() -> None:
    made = SceneBuilder("a")
    made.add("Chair", uid="c", category="Chair", mesh=chair(1))
    asset = Asset("Chair", made.build())
    turned = front_first(asset)
    points = asset.graph.meshes[0].points @ turned.graph.world[0, :3, :3].T
    plain = chair(0).points
    np.testing.assert_allclose(points.max(axis=0), plain.max(axis=0), atol=1e-5)
    assert front_first(turned) is turned


@pytest.mark.parametrize("world", [living_room, operating_room])
def test_our_own_rooms_are_seen_as_they_were(world) -> None:
    graph = world(11)
    objects = scene_objects(graph, graph.vocabulary)
    movable = np.ones(len(objects), bool)
    seen = facing(objects, graph, movable, None)
    np.testing.assert_array_equal(seen.yaw, objects.yaw)
    np.testing.assert_array_equal(seen.half, objects.half)

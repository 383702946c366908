"""What walls enclose, in rooms at any angle, and that places on the floor are tried nowhere else."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.generate.rooms import at, box
from tests.spatial.built_rooms import L_SHAPE, SQUARE, TRIANGLE, grown
from unisg_blender.generate.observe.observed_scene import ObservedScene
from unisg_blender.generate.observe.prior_tables import PriorTables
from unisg_blender.generate.observe.room_walls import RoomWalls
from unisg_blender.generate.observe.seen_places import SeenPlaces
from unisg_blender.generate.observe.support_priors import learn_priors
from unisg_blender.generate.propose.plain_proposals import SHARES, TriedRoom, plain_proposals
from unisg_blender.geometry.planar import rotate
from unisg_blender.geometry.polygon import inside
from unisg_blender.scene import SceneBuilder, SceneGraph, world_matrices
from unisg_blender.spatial.objects import scene_objects

THICK = 0.1


def walled(outline: np.ndarray, yaw: float, stools: np.ndarray, door: bool = True) -> SceneGraph:
    """A floor as wide as the outline reaches, a wall of 10 cm outside each edge, a door, stools; all turned."""
    builder, middle = SceneBuilder("Room"), (outline.min(axis=0) + outline.max(axis=0)) / 2
    width, depth = np.ptp(outline, axis=0)

    def put(name: str, mesh: object, place: np.ndarray, turned: float = 0.0, parent: int = -1) -> int:
        x, y = rotate(place - middle, np.array(yaw))
        local = at(x, y, 0, yaw + turned)
        return builder.add(name, uid=f"{len(builder._names)}", category=name, mesh=mesh, local=local, parent=parent)

    put("Floor", box("floor", width, depth, -0.1), middle)
    for number, (start, stop) in enumerate(zip(outline, np.roll(outline, -1, axis=0), strict=True)):
        length, along = np.linalg.norm(stop - start), (stop - start) / np.linalg.norm(stop - start)
        out = np.array([along[1], -along[0]])
        turned = float(np.arctan2(along[1], along[0]))
        put("Wall", box("wall", length, THICK, 2.5), (start + stop) / 2 + out * THICK / 2, turned)
        if door and number == 0:
            put("Door", box("door", 0.9, 0.08, 2.1), start + along * 1.2 + out * THICK / 2, turned)
    for place in stools:
        put("Stool", box("stool", 0.3, 0.3, 0.5), place)
    return builder.build()


def tried(graph: SceneGraph) -> tuple[ObservedScene, PriorTables]:
    objects = scene_objects(graph, graph.vocabulary)
    tables = PriorTables.of(learn_priors([objects], graph.vocabulary), graph.vocabulary)
    return ObservedScene.of(objects, world_matrices(graph)[objects.row]), tables


def places_in(outline: np.ndarray, count: int, rng: np.random.Generator) -> np.ndarray:
    """Places in an outline, not nearer than 0.3 m to its edges."""
    found = rng.uniform(outline.min(axis=0), outline.max(axis=0), (4000, 2))
    around = [inside(outline, found + 0.3 * np.array([np.cos(a), np.sin(a)])) for a in np.linspace(0, 2 * np.pi, 16)]
    return found[np.all(around, axis=0)][:count]


@pytest.mark.parametrize("outline", [SQUARE, L_SHAPE, TRIANGLE], ids=["square", "l", "triangle"])
@given(yaw=st.floats(-3.2, 3.2), door=st.booleans())
def test_walls_enclose_what_is_within_their_outline(outline: np.ndarray, yaw: float, door: bool) -> None:
    rng = np.random.default_rng(0)
    scene, tables = tried(walled(outline, yaw, np.zeros((0, 2)), door))
    middle = (outline.min(axis=0) + outline.max(axis=0)) / 2
    places = rng.uniform(outline.min(axis=0) - 2, outline.max(axis=0) + 2, (300, 2))
    beside = [inside(outline, places + 0.15 * np.array([np.cos(a), np.sin(a)])) for a in np.linspace(0, 2 * np.pi, 9)]
    clear = np.all(beside, axis=0) | ~np.any(beside, axis=0)  # not within a wall
    found = RoomWalls.of(scene, tables).inside(rotate(places[clear] - middle, np.full(clear.sum(), yaw)))
    np.testing.assert_array_equal(found, inside(outline, places[clear]))


@pytest.mark.parametrize("yaw", [0.0, 0.7])
def test_no_place_is_tried_beyond_the_walls_of_an_l(yaw: float) -> None:
    rng = np.random.default_rng(1)
    scene, tables = tried(walled(L_SHAPE, yaw, places_in(L_SHAPE, 6, rng)))
    places = SeenPlaces.of([scene], tables)
    (category,) = places.places
    stool, room = int(np.flatnonzero(scene.category == category)[0]), TriedRoom.of(scene, tables)
    middle, allowed = (L_SHAPE.min(axis=0) + L_SHAPE.max(axis=0)) / 2, np.ones(len(scene.category), bool)
    allowed[scene.category == category] = False
    assert room.enclosed
    upto = grown(L_SHAPE, THICK / 2 + 1e-9)  # the middles of the walls
    for ways in (SHARES, (0.0, 0.0, 0.0, 1.0)):
        found = plain_proposals(room, places.of_category(category), scene.half[stool], allowed, 400, rng, ways)
        there = rotate(found.places[:, :2], np.full(400, -yaw)) + middle
        assert inside(upto, there).all()


def test_walls_of_several_rooms_enclose_nothing() -> None:
    """Where things stand outside as often as inside of the walls, the walls decide nothing."""
    stools = np.array([[1.0, 1.0], [9.0, 1.0], [9.0, 3.0], [-3.0, 2.0], [2.0, 8.0]])
    scene, tables = tried(walled(SQUARE, 0.0, stools))
    assert not TriedRoom.of(scene, tables).enclosed

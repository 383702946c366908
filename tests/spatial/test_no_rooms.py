"""What is no room, or hardly one, is said in an honest sentence, soon."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from unisg_blender.scene import Mesh, SceneBuilder, SceneGraph
from unisg_blender.spatial.structure import recognise_structure

from .built_rooms import L_SHAPE, SQUARE, box, grid_mesh, joined, mesh, of_mesh, room, scene, slab, walls


def soup(count: int, size: float, seed: int = 0) -> SceneGraph:
    """Triangles anywhere within 10 m, their corners so many metres apart."""
    generator = np.random.default_rng(seed)
    points = generator.uniform(-5, 5, (count, 1, 3)) + generator.uniform(-size, size, (count, 3, 3)) / 2
    corners = np.arange(3 * count, dtype=np.int32)
    return of_mesh(
        Mesh("Soup", points.reshape(-1, 3).astype(np.float32), corners, np.arange(count + 1, dtype=np.int32) * 3)
    )


def figure() -> SceneGraph:
    """Legs, a trunk, arms and a head."""
    limbs = [box((x, -0.1, 0), (x + 0.15, 0.1, 0.9)) for x in (-0.2, 0.05)]
    limbs += [box((-0.2, -0.12, 0.9), (0.2, 0.12, 1.5)), box((-0.1, -0.1, 1.5), (0.1, 0.1, 1.8))]
    return scene({"figure": joined([*limbs, box((-0.9, -0.05, 1.35), (0.9, 0.05, 1.45))])})


def hills(x, y):
    return 8 * np.sin(x / 9) * np.cos(y / 7)


SENTENCES: dict[str, tuple[Callable[[], SceneGraph], str]] = {
    "walls without a floor": (
        lambda: scene({str(n): part for n, part in enumerate(walls(L_SHAPE, 0, 2.5, 0.2))}),
        "a plane under them",
    ),
    "hills": (lambda: of_mesh(grid_mesh(80, 100, hills)), "nowhere are 4 m2 level"),
    "a figure": (figure, "no room, but a thing"),
    "small triangles anywhere": (lambda: soup(5000, 0.4), "nowhere are 4 m2 level"),
    "open land": (lambda: of_mesh(grid_mesh(20, 1000, lambda x, y: 0 * x)), "only open ground"),
    "a room a metre wide": (lambda: scene(room(0.2 * SQUARE, 0.05)), "is its unit right"),
    "a room a kilometre wide": (lambda: scene(room(200 * SQUARE, 0.2, height=8, roof=True)), "is its unit right"),
}


@pytest.mark.parametrize("name", SENTENCES)
def test_what_is_no_room_is_said(name: str) -> None:
    make, sentence = SENTENCES[name]
    structure = recognise_structure(make())
    assert not any(found.indoors for found in structure.rooms)
    assert any(sentence in note for note in structure.notes)


@pytest.mark.slow
def test_large_triangles_anywhere_end() -> None:
    """Layer upon layer: what would be seen a hundred million times is seen more coarsely."""
    structure = recognise_structure(soup(1500, 12.0))
    assert structure.cell > 0.05


def test_a_hall_of_a_hundred_metres_is_a_room() -> None:
    (found,) = recognise_structure(scene(room(20 * SQUARE, 0.3, height=7, roof=True))).rooms
    assert found.indoors
    assert found.area == pytest.approx(8000, rel=1e-3)


def test_a_finely_meshed_floor_is_the_same_floor() -> None:
    """Many faces that none of the columns meets."""
    objects = {name: part for name, part in room(2 * SQUARE, 0.2).items() if name != "ground"}
    graph = scene(objects | {"ground": slab(2 * SQUARE, 0.0, 0.0)})
    coarse = recognise_structure(graph).rooms[0]
    grid = grid_mesh(400, 1.0, lambda x, y: 0.001 * np.sin(50 * x))
    points = ((grid.points + np.array([0.5, 0.5, 0.0])) * (10, 8, 1)).astype(np.float32)
    builder = SceneBuilder("Built")
    builder.add("floor", uid="floor", mesh=Mesh("Floor", points, grid.corners, grid.offsets))
    for name, part in objects.items():
        builder.add(name, uid=name, mesh=mesh(part))
    assert recognise_structure(builder.build()).rooms[0].area == pytest.approx(coarse.area, rel=1e-3)

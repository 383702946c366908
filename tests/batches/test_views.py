"""From where pictures are taken: eyes, corners, looks from outside, in rooms of one mesh too."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.spatial import built_rooms
from unisg_blender.batches.pictures.picture_labels import labelled
from unisg_blender.batches.pictures.surround import FROM_THING, Surround
from unisg_blender.batches.pictures.view_choice import choose_views, parse_views
from unisg_blender.errors import UniSGError
from unisg_blender.geometry.polygon import inside
from unisg_blender.scene import SceneBuilder, SceneGraph
from unisg_blender.spatial.structure import recognise_structure
from unisg_blender.worlds import cubes, living_room


@pytest.mark.slow
@settings(max_examples=5, deadline=None)
@given(seed=st.integers(0, 100))
def test_eyes_are_in_the_room_and_see_something(seed: int) -> None:
    graph = labelled(living_room(seed))
    room = recognise_structure(graph).rooms[0]
    rng = np.random.default_rng(seed)
    views = choose_views(graph, {"eye": 2, "corners": 1, "dollhouse": 1, "turntable": 2, "Sofa": 1}, (64, 48), rng)
    assert [chosen.view.name for chosen in views] == [
        "eye 0", "eye 1", "corners 0", "dollhouse 0", "turntable 0", "turntable 1", "Sofa 0",
    ]  # fmt: skip
    for chosen in (*views[:3], views[-1]):
        assert room.contains(chosen.view.world[None, :2, 3])[0]
        assert room.floor + 0.5 < chosen.view.world[2, 3] < room.ceiling
        assert not chosen.hidden.any()
    walls = [row for row in range(len(graph)) if graph.category_name(row) == "Wall"]
    assert 0 < views[3].hidden[walls].sum() < len(walls)
    assert views[4].hidden[walls].all()
    for chosen in views:
        pixels, depth = chosen.view.project(graph.world[:, :3, 3])
        assert ((depth > 0) & (pixels > 0).all(axis=1) & (pixels < (64, 48)).all(axis=1)).sum() > 3


def test_views_that_there_are_not() -> None:
    graph = labelled(living_room(1))
    rng = np.random.default_rng(0)
    with pytest.raises(UniSGError, match="there is no 'Elephant' in the scene"):
        choose_views(graph, {"Elephant": 1}, (64, 48), rng)
    with pytest.raises(UniSGError, match="no camera"):
        choose_views(graph, {"scene": 1}, (64, 48), rng)
    with pytest.raises(UniSGError, match="shows nothing"):
        choose_views(SceneBuilder("x").build(), {"eye": 1}, (64, 48), rng)


def boxes(*sizes: tuple[float, float, float]) -> SceneGraph:
    """Boxes around one place of the floor."""
    builder, mesh = SceneBuilder("boxes"), cubes(0).meshes[0]
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    for number, size in enumerate(sizes):
        local = np.diag([*(np.array(size) / (high - low)), 1.0])
        local[:3, 3] = [0, 0, size[2] / 2] - local[:3, :3] @ (low + high) / 2
        builder.add(f"Box {number}", uid=f"box{number}", mesh=mesh, local=local)
    return builder.build()


def test_what_is_around_a_room_is_not_in_the_way() -> None:
    """Of a room that is a single mesh the faces are in the way, not the box."""
    size = np.array([6.0, 5.0, 3.0])
    for sizes, taken in (([size], 0.0), ([size, (2.0, 1.0, 0.8)], 1.0)):
        graph = boxes(*sizes)
        places = Surround.of(labelled(graph), graph).standing_places(np.random.default_rng(0))
        assert len(places) > 20
        assert (np.abs(places) <= size[:2] / 2 - FROM_THING).all()
        assert ((np.abs(places) > [taken * 1.25, taken * 0.75]).any(axis=1)).all()


def test_views_that_nobody_asked_for() -> None:
    """Eyes where somebody can stand, else looks from outside, which see as far as a scene in millimetres is large."""
    rng = np.random.default_rng(0)
    room = choose_views(labelled(boxes((6, 5, 3))), None, (64, 48), rng)
    assert [chosen.view.name for chosen in room] == ["eye 0", "eye 1"]
    tight = choose_views(labelled(boxes((0.5, 0.5, 3))), None, (64, 48), rng)
    assert [chosen.view.name for chosen in tight] == ["dollhouse 0", "dollhouse 1"]
    for chosen in choose_views(labelled(boxes((6000, 5000, 3000))), {"dollhouse": 1}, (64, 48), rng):
        assert chosen.view.project(np.zeros((1, 3)))[1] < chosen.view.clip[1]


@pytest.mark.parametrize("text", ["eye=x", "eye=0", "", "=2", "eye=-1"])
def test_views_that_are_none(text: str) -> None:
    with pytest.raises(UniSGError, match="--views must look like"):
        parse_views(text)


def house(name: str, *, roof: bool = True) -> SceneGraph:
    """An L-shaped room of one mesh, with a table in the corner of the longer leg."""
    parts = built_rooms.room(built_rooms.L_SHAPE, roof=roof, one="all")
    (shell,) = parts.values()
    return built_rooms.scene({name: shell, "Table": built_rooms.table(5.0, 1.5, 0.0)})


@pytest.mark.parametrize("name", ["Cube", "Room", "Chair"])
def test_a_room_of_one_mesh_is_looked_at_from_within_whatever_it_is_called(name: str) -> None:
    """No wall stands between a camera and what it looks at: of an L one leg is not seen from the other's end."""
    graph, rng = house(name), np.random.default_rng(0)
    for chosen in choose_views(labelled(graph), {"corners": 8, "eye": 4}, (64, 48), rng, graph):
        place = chosen.view.world[:3, 3]
        ways = place + np.linspace(0, 1, 40)[:, None] * (np.array([5.0, 1.5, 0.375]) - place)
        assert inside(built_rooms.L_SHAPE, ways[:, :2]).all()
        assert 0.5 < place[2] < 2.5


@pytest.mark.parametrize("size", [(64, 48), (48, 64)])
def test_a_house_of_one_mesh_is_cut_below_its_ceiling(size: tuple[int, int]) -> None:
    """Nothing of it can be left out, so its dollhouse is a plan: parallel rays, all of the room in the picture."""
    graph, rng = house("Cube"), np.random.default_rng(0)
    (chosen,) = choose_views(labelled(graph), {"dollhouse": 1}, size, rng, graph)
    view = chosen.view
    assert view.orthographic
    assert not chosen.hidden.any()
    assert 1.5 < view.world[2, 3] - view.clip[0] < 2.5
    pixels, depth = view.project(np.column_stack([built_rooms.L_SHAPE, np.zeros(6)]))
    assert ((pixels >= 0) & (pixels <= size)).all()
    assert (depth < view.clip[1]).all()
    assert np.ptp(pixels, axis=0).max() > 0.6 * min(size)


def test_a_corner_of_a_place_that_nothing_sees_from_is_none() -> None:
    graph, rng = living_room(1), np.random.default_rng(0)
    room = recognise_structure(graph).rooms[0]
    for chosen in choose_views(labelled(graph), {"corners": 5}, (64, 48), rng, graph):
        assert room.contains(chosen.view.world[None, :2, 3])[0]

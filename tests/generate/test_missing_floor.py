"""Walls without a floor, as rooms for robots have them: a plane is put under them, once, and it is told."""

from __future__ import annotations

import numpy as np
import pytest

from tests.spatial.built_rooms import DOOR, L_SHAPE, SQUARE, box, mesh, room, scene, table, walls
from unisg_blender.generate import Generator
from unisg_blender.geometry.polygon import inside
from unisg_blender.pretrained import find_generator
from unisg_blender.scene import SceneBuilder, SceneGraph
from unisg_blender.spatial.structure.missing_floor import missing_floor


@pytest.fixture(scope="module")
def living() -> Generator:
    return Generator.load(find_generator("living_room"))


def floorless(outline: np.ndarray = SQUARE, bottom: float = 0.0, **others) -> SceneGraph:
    """Walls, with a door, and what else there is; no floor."""
    sides = walls(outline, bottom, bottom + 2.6, 0.1, (DOOR,))
    return scene({f"side {number}": part for number, part in enumerate(sides)} | others)


@pytest.mark.parametrize("outline", [SQUARE, L_SHAPE], ids=["square", "l"])
def test_things_stand_on_a_plane_that_is_put_under_walls(living: Generator, outline: np.ndarray) -> None:
    made = living.add(floorless(outline, table=table(1.5, 1.5, 0)), {"Chair": 1, "Plant": 1}, 1, behaviour=False)
    floor, *things = made.objects
    assert (floor.category, floor.note) == ("Floor", "the walls had no floor: a plane was put under them")
    assert [thing.support for thing in things] == [floor.name] * 2
    assert all(inside(outline, thing.world[None, :2, 3])[0] for thing in things)
    assert len(made.scene) == len(made.rows) + 5 + 2 * (len(outline) == 6)


def test_the_plane_reaches_under_all_walls() -> None:
    assert missing_floor(floorless()) == pytest.approx(np.array([[-0.1, -0.1, 0], [5.1, 4.1, 0]]))


@pytest.mark.parametrize(("bottom", "ground"), [(0.09, 0.0), (-0.05, 0.0), (1.4, 1.4), (-3.0, -3.0)])
def test_the_ground_is_at_height_0_or_at_the_feet_of_walls(bottom: float, ground: float) -> None:
    found = missing_floor(floorless(bottom=bottom))
    assert found is not None
    assert found[:, 2] == pytest.approx(ground)


def test_a_floor_asked_for_is_that_plane(living: Generator) -> None:
    made = living.add(floorless(), {"Floor": 1, "Wall": 1, "Chair": 1}, 1, behaviour=False)
    assert [(item.category, item.refused) for item in made.objects] == [
        ("Floor", False), ("Wall", True), ("Chair", False)
    ]  # fmt: skip


def test_a_second_time_no_plane_is_put(living: Generator) -> None:
    once = living.add(floorless(), {"Chair": 1}, 1, behaviour=False).scene
    made = living.add(once, {"Plant": 1}, 1, behaviour=False)
    assert [item.category for item in made.objects] == ["Plant"]


def test_a_whole_room_lacks_no_walls_where_walls_stand(living: Generator) -> None:
    builder = SceneBuilder()
    for number, part in enumerate(walls(SQUARE, 0, 2.6, 0.1, (DOOR,))):
        builder.add(f"side {number}", uid=f"side {number}", mesh=mesh(part), category="Wall")
    counts = living.sample_counts(np.random.default_rng(1), builder.build())
    assert counts
    assert not {"Floor", "Wall", "Ceiling"} & set(counts)


NONE = {
    "with a floor": lambda: scene(room(SQUARE)),
    "things only": lambda: scene({"table": table(0, 0, 0)}),
    "a single wall": lambda: scene({"wall": box((0, 0, 0), (4, 0.1, 2.6))}),
    "tall cabinets in a row": lambda: scene({str(n): box((n, 0, 0), (n + 0.9, 0.6, 2.1)) for n in range(5)}),
    "nothing": lambda: scene({}),
}


@pytest.mark.parametrize("name", NONE)
def test_what_is_no_room_or_has_a_floor_gets_none(name: str) -> None:
    assert missing_floor(NONE[name]()) is None

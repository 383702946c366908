"""What a model does not know stands by rules: back to a wall, on the floor, on furniture, free before it."""

from __future__ import annotations

import numpy as np
import pytest

from tests.generate.test_foreign_rooms import check
from tests.spatial.built_rooms import DOOR, SQUARE, room, scene
from tests.words.foreign_scenes import kitchen
from unisg_blender.errors import UniSGError
from unisg_blender.generate import Generator
from unisg_blender.generate.place.placed_by_rules import NOTE
from unisg_blender.geometry.polygon import to_edges
from unisg_blender.pretrained import find_generator


@pytest.fixture(scope="module")
def generator() -> Generator:
    return Generator.load(find_generator("living_room"))


@pytest.mark.parametrize("seed", range(4))
def test_fridges_stand_with_their_backs_to_walls(generator: Generator, seed: int) -> None:
    graph = scene(room(SQUARE, 0.1, holes=(DOOR,)))
    made = generator.add(graph, {"Kühlschrank": 1, "washing machine": 2}, seed)
    check(made, SQUARE, 0.0, least=3)
    for item in made.objects:
        assert item.note == NOTE
        assert item.world is not None
        back = item.world[:3, :3] @ np.array([0.0, 1.0, 0.0])
        reach = to_edges(SQUARE, (item.world[:2, 3] + 0.3 * back[:2])[None]).min()
        assert reach < 0.11  # the middle of the back is at the wall


def test_known_and_unknown_things_in_one_call(generator: Generator) -> None:
    made = generator.add(kitchen(), {"Toaster": 2, "Plate": 1, "Fridge": 1}, 1)
    by_name = {item.category: item for item in made.objects}
    assert by_name["Toaster"].support == "Table"
    assert by_name["Toaster"].note == NOTE
    assert by_name["Plate"].note == ""
    shape = made.scene.row_of_uid[by_name["Refrigerator"].uid]
    own = made.scene.name.index("Fridge.001")
    assert made.scene.mesh[shape] == made.scene.mesh[own]  # another of the user's own


def test_same_seed_same_places(generator: Generator) -> None:
    one, two = (generator.add(kitchen(), {"Bed": 1, "Chair": 1}, 5).objects for _ in range(2))
    for first, second in zip(one, two, strict=True):
        assert (first.world is None) == (second.world is None)
        assert first.world is None or np.allclose(first.world, second.world)


def test_what_nobody_knows_is_refused(generator: Generator) -> None:
    with pytest.raises(UniSGError, match="the model does not know 'Excavator'"):
        generator.add(kitchen(), {"Excavator": 1}, 0)


def test_what_finds_no_room_is_refused(generator: Generator) -> None:
    made = generator.add(kitchen(), {"Piano": 20}, 0)
    assert made.refused
    assert all(item.note.startswith(f"{NOTE}; no free place was found") for item in made.refused)

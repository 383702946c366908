"""Rooms of other kinds and in other words: told before anything is added, and nothing built is brought in."""

from __future__ import annotations

import numpy as np
import pytest

from tests.spatial.built_rooms import SQUARE, box, room, scene
from tests.words.foreign_scenes import bedroom, house, kitchen, parlour
from unisg_blender.errors import UniSGError
from unisg_blender.generate import Generator
from unisg_blender.pretrained import find_generator
from unisg_blender.scene.categories import STRUCTURE


@pytest.fixture(scope="module")
def generator() -> Generator:
    return Generator.load(find_generator("living_room"))


@pytest.mark.parametrize("model", ["living_room", "operating_room"])
@pytest.mark.parametrize("room", [kitchen, bedroom])
def test_a_room_of_another_kind_is_not_filled_blindly(model: str, room) -> None:
    with pytest.raises(UniSGError, match=r"looks like a (kitchen|bedroom), \d of its \d things are known.*--add"):
        Generator.load(find_generator(model)).sample_counts(np.random.default_rng(0), room())


def test_a_room_of_its_kind_gets_what_it_lacks(generator: Generator) -> None:
    counts = generator.sample_counts(np.random.default_rng(1), parlour())
    whole = generator.sample_counts(np.random.default_rng(1))
    assert not set(STRUCTURE) & set(counts)
    assert counts.get("Sofa", 0) == whole.get("Sofa", 0) - 1
    assert counts["Book"] == whole["Book"]


def test_other_words_are_seen_and_asked_for(generator: Generator) -> None:
    made = generator.add(kitchen(), {"Teller": 2, "Stühle": 1}, 3)
    assert [item.category for item in made.objects] == ["Chair", "Plate", "Plate"]
    assert {item.support for item in made.objects if item.category == "Plate"} == {"Table"}
    assert made.scene.category_name(made.scene.name.index("Table")) == ""  # the user's own scene keeps its words
    assert made.reading is not None
    assert (made.reading.known, len(made.reading.things), made.reading.kind) == (2, 6, "kitchen")


def test_words_that_may_mean_several_are_asked_back(generator: Generator) -> None:
    with pytest.raises(UniSGError, match="'Table': did you mean 'Dining Table' or 'Coffee Table' or 'Side Table'"):
        generator.understood({"Table": 1})
    assert generator.understood({"Table": 1}, {"table": "Side Table"}) == {"Side Table": 1}


def test_of_a_house_the_room_that_is_used_is_read(generator: Generator) -> None:
    scene = house()
    whole, cook = generator.read(scene), generator.read(scene, near="Fridge.001")
    assert (whole.rooms, whole.kind, whole.known, len(whole.things)) == (2, "living room", 4, 4)
    assert not whole.is_foreign
    assert (cook.kind, cook.known, len(cook.things)) == ("kitchen", 0, 4)
    assert cook.is_foreign
    assert cook.summary.startswith("0 of 4 things in this one of 2 rooms")
    made = generator.add(scene, {"Cup": 1}, 0, beside="SM_Stove_01", behaviour=False)
    assert made.reading is not None
    assert made.reading.kind == "kitchen"


@pytest.mark.parametrize(("width", "copied"), [(0.06, False), (0.5, True)])
def test_a_mere_part_is_no_shape_of_its_category(generator: Generator, width: float, copied: bool) -> None:
    """A pole that is called a chair is not what a new chair looks like."""
    parts = room(SQUARE, 0.1) | {"chair_01": box((1, 1, 0), (1 + width, 1 + width, 0.9))}
    made = generator.add(scene(parts), {"Chair": 1}, 0)
    (new,) = made.rows[made.scene.mesh[made.rows] >= 0][:1]
    assert (made.scene.meshes[made.scene.mesh[new]].name == made.scene["chair_01"].mesh.name) == copied


def test_a_scene_in_which_no_room_is_recognised_is_doubted_before_anything_is_added(generator: Generator) -> None:
    toy = scene(room(0.1 * SQUARE, 0.01, height=0.25))
    assert any("is its unit right?" in line for line in generator.read(toy).lines())
    assert generator.read(scene(room(SQUARE, 0.1))).lines() == []

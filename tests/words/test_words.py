"""Other people's words: names and categories of any make in the vocabulary of a model."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.meshes.shapes import box
from tests.words.foreign_scenes import bedroom, kitchen
from unisg_blender.errors import UniSGError
from unisg_blender.scene import SceneBuilder
from unisg_blender.words import VocabularyMatch, thing_table, understand
from unisg_blender.words.room_kinds import room_kind
from unisg_blender.words.split_names import singular_forms
from unisg_blender.words.word_table import read_table

LIVING = ("Armchair", "Cabinet", "Chair", "Coffee Table", "Dining Table", "Floor Lamp", "Side Table", "Sofa",
          "Table Lamp", "Television")  # fmt: skip
LANGUAGES = ("de", "en", "es", "fr", "it", "ja", "zh")


@pytest.mark.parametrize(
    ("name", "thing"),
    [
        ("Chair.001", "Chair"), ("chair_03", "Chair"), ("CHAIRS", "Chair"), ("SM_Chair_01a", "Chair"),
        ("Prop_CoffeeTable_LOD0", "Coffee Table"), ("tvstand", "Television Stand"), ("Küchenstuhl", "Chair"),
        ("Kuechenstuhl.002", "Chair"), ("canapé", "Sofa"), ("canape_rouge", "Sofa"),
        ("silla de oficina", "Office Chair"),
        ("mesa_de_centro", "Coffee Table"), ("comodino", "Nightstand"), ("ダイニングテーブル", "Dining Table"),
        ("床头柜_2", "Nightstand"), ("木椅", "Chair"), ("Bottle of wine", "Bottle"), ("Wall_Clock", "Clock"),
        ("cabinet_36_wall", "Cabinet"), ("bookcase", "Bookshelf"), ("Bücherregal", "Bookshelf"),
    ],
)  # fmt: skip
def test_names_of_all_makes(name: str, thing: str) -> None:
    reading = thing_table().read(name)
    assert (reading.thing, reading.part) == (thing, False)


@pytest.mark.parametrize(
    "name", ["Chair_Leg_FR", "Cabinet_Door_L", "desk drawer", "DishSponge", "Chair Middle", "Plant Leaves"]
)
def test_parts_are_no_things(name: str) -> None:
    assert thing_table().read(name).part


NAMES_OF_NOTHING = ["", "Cube.004", "UCX_Chair_01", "wallpaper", "Object_17", "livingroom", "four", "furnitures_root"]


@pytest.mark.parametrize("name", [*NAMES_OF_NOTHING, "fridge_area_footprint", "vegetable"])
def test_names_that_say_nothing(name: str) -> None:
    assert thing_table().read(name).thing == ""


@given(st.text(max_size=30))
def test_any_text_is_read(text: str) -> None:
    assert thing_table().read(text).thing in {"", *thing_table().things}


@given(st.sampled_from(sorted(thing_table().things)), st.sampled_from(("{}", "SM_{}_01a", "{}.012", "prop_{}_LOD1")))
def test_every_thing_is_found_by_its_own_name(thing: str, make: str) -> None:
    assert thing_table().read(make.format(thing.replace(" ", ""))).thing == thing


def test_the_table_is_sound() -> None:
    table, meant = thing_table(), {}
    for thing in table.things.values():
        assert set(thing.broader) <= set(table.things)
        for words in thing.words.values():
            for word in words:
                assert word
                assert meant.setdefault(word.casefold(), thing.name) == thing.name
    assert sum(set(LANGUAGES) <= set(thing.words) for thing in table.things.values()) >= 60


def test_held_out_names_of_others() -> None:
    with (Path(__file__).parents[2] / "benchmarks" / "names.csv").open(newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["half"] == "held-out"]
    read = [thing_table().read(row["name"]) for row in rows]
    wrong = [row for row, one in zip(rows, read, strict=True) if not one.part and one.thing not in ("", row["thing"])]
    assert len(rows) == 100
    assert len(wrong) <= 2


def test_synonyms_broader_and_narrower_terms() -> None:
    words = VocabularyMatch(LIVING)
    assert (words.match("Couch").category, words.match("Couch").how) == ("Sofa", "word")
    assert (words.match("chairs").category, words.match("chairs").how) == ("Chair", "same")
    nightstand = words.match("Nightstand")
    assert (nightstand.category, nightstand.how) == ("Side Table", "kind")  # told as broader, and no Cabinet
    table = words.match("Table")
    assert (table.category, table.how, table.others) == ("Dining Table", "broad", ("Coffee Table", "Side Table"))
    assert words.match("Excavator").category == ""


def test_a_broader_term_is_told_by_its_size() -> None:
    sizes = {"Coffee Table": (1.1, 0.6, 0.42), "Dining Table": (1.6, 0.9, 0.75), "Side Table": (0.5, 0.5, 0.55)}
    words = VocabularyMatch(LIVING, sizes=sizes)
    assert words.match("Table", np.array([1.0, 0.7, 0.4])).category == "Coffee Table"
    assert words.match("Table", np.array([0.9, 1.8, 0.75])).category == "Dining Table"


def test_a_vocabulary_in_other_words() -> None:
    assert VocabularyMatch(("Couch", "Esstisch")).match("SM_Sofa_2").category == "Couch"
    assert VocabularyMatch(("Büroklammer",)).match("Büroklammer_07").category == "Büroklammer"
    assert VocabularyMatch(("Implant Box",)).match("Box").category == ""  # a special box is not what any box is


def test_what_the_user_says_counts_first() -> None:
    words = VocabularyMatch(LIVING, {"Nightstand": "Cabinet", "couch": "", "Ding": "Chair"})
    assert words.match("nightstand.003").category == "Cabinet"
    assert words.match("Couch").category == ""
    assert words.match("Ding_2").category == "Chair"


def test_a_scene_of_somebody_else() -> None:
    read = understand(kitchen(), LIVING)
    found = {name: read.graph.category_name(row) for row, name in enumerate(read.graph.name)}
    assert {name: category for name, category in found.items() if category} == {
        "Table": "Dining Table", "Stuhl_03": "Chair"
    }  # fmt: skip
    assert {item.match.thing for item in read.understood} >= {"Refrigerator", "Cooker", "Sink"}


def test_known_words_leave_a_scene_as_it_is() -> None:
    made = SceneBuilder("own")
    made.add("A", uid="a", category="Chair", mesh=box((1, 1, 1)))
    graph = made.build()
    assert understand(graph, LIVING).graph is graph
    assert understand(graph, LIVING).lines() == []


def test_a_table_of_an_empty_and_two_meshes_is_one_thing() -> None:
    made = SceneBuilder("parts")
    whole = made.add("Table", uid="t")
    made.add("Table_Top", uid="top", parent=whole, mesh=box((1, 1, 0.1)))
    made.add("Table_Leg", uid="leg", parent=whole, mesh=box((0.1, 0.1, 0.7)))
    many = made.add("Chairs", uid="c")
    for number in range(2):
        made.add(f"Chair.{number}", uid=f"c{number}", parent=many, mesh=box((0.4, 0.4, 0.9)))
    read = understand(made.build(), LIVING)
    found = {name: read.graph.category_name(row) for row, name in enumerate(read.graph.name)}
    assert found == {
        "Table": "Dining Table", "Table_Top": "", "Table_Leg": "", "Chairs": "", "Chair.0": "Chair", "Chair.1": "Chair",
    }  # fmt: skip


def test_nested_names_of_one_thing_are_one_thing() -> None:
    made = SceneBuilder("nested")
    top = made.add("CoffeeTable_01_001", uid="a")
    model = made.add("aws_robomaker_CoffeeTable_01", uid="b", parent=top)
    visual = made.add("visual", uid="c", parent=model)
    made.add("aws_CoffeeTable_01_visual", uid="d", parent=visual, mesh=box((1, 1, 0.4)))
    read = understand(made.build(), LIVING)
    assert [read.graph.category_name(row) for row in range(4)] == ["Coffee Table", "", "", ""]


def test_kinds_of_rooms() -> None:
    for room, kind in ((kitchen(), "kitchen"), (bedroom(), "bedroom")):
        assert room_kind(item.match.thing for item in understand(room, LIVING).understood) == kind
    assert room_kind(()) == ""
    assert room_kind(("Chair",)) == ""


def test_plurals() -> None:
    assert "couch" in singular_forms("couches")
    assert singular_forms("glass") == ("glass",)


def test_a_damaged_table_is_told(tmp_path: Path) -> None:
    for text, message in (
        ("[Chair", "not valid TOML"),
        ("Chair = 1", "must be a table"),
        ("Chair.en = 2", "must be text"),
    ):
        (tmp_path / "t.toml").write_text(text)
        with pytest.raises(UniSGError, match=message):
            read_table(tmp_path / "t.toml")

"""Files of what varies: the example says all that there is, every mistake is one line that says what is meant."""

from __future__ import annotations

import json
import tomllib
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest

from unisg_blender.errors import UniSGError
from unisg_blender.generate.variation.variation import TRAINING, Count, Jitter, Variation
from unisg_blender.generate.variation.variation_file import read_record, variation_from

EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"
NAMES = {field.name for field in fields(Variation)}


def test_the_example_says_all_that_there_is() -> None:
    record = read_record(EXAMPLES / "variations.toml")
    assert set(record) == NAMES
    variation = variation_from(record)
    assert variation.counts["Scalpel"] == Count(1, 3)
    assert variation.counts["Monitor"] == Count(2, 2)
    assert variation.counts["Clamp"] == Count(2, 6, 0.5)
    assert variation.counts["Stool"] == Count(like=TRAINING)
    assert variation.reroll == {"Chair": 1.0, "Book": 1.0}
    assert variation.remove == {"Waste Bin": 0.5}
    assert variation.jitter == Jitter(0.03, 5.0, ("*",))


def test_the_schema_has_the_same_keys() -> None:
    schema = json.loads((EXAMPLES / "variations.schema.json").read_text())
    assert set(schema["properties"]) == NAMES
    assert set(schema["properties"]["jitter"]["properties"]) == {field.name for field in fields(Jitter)}
    assert schema["additionalProperties"] is False


def test_nothing_said_is_nothing_varied() -> None:
    assert variation_from({}) == Variation()


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("rerol = ['Chair']", "did you mean 'reroll'"),
        ("counts = 3", r"must be a table: \[counts\]"),
        ("[counts]\nChair = [3, 1]", "counts: Chair must be a range upward"),
        ("[counts]\nChair = [-1, 1]", "counts: Chair must be a range upward"),
        ("[counts]\nChair = [1, 1000000]", "counts: Chair must be a range upward"),
        ("[counts]\nChair = 1.5", "counts: Chair must be a number, a range"),
        ("[counts]\nChair = true", "counts: Chair must be a number, a range"),
        ("[counts]\nChair = 'as in trainin'", "counts: Chair must be a number, a range"),
        ("[counts]\nChair = { chance = 2 }", "must be a number from 0 to 1"),
        ("[counts]\nChair = { many = 2 }", "has no 'many'"),
        ("rest = 'all'", "rest must be one of"),
        ("lock = 'Table'", r"lock must be a list of names such as \["),
        ("swap = { Chair = 'often' }", "swap: Chair, a share, must be a number from 0 to 1"),
        ("lesson = 1", "lesson must be true or false"),
        ("tries = 0", "tries must be a number from 1"),
        ("tries = 1.5", "tries must be a whole number"),
        ("refused = nan", "must be a number from 0 to 1"),
        ("[jitter]\ndistance = -1", "jitter: distance, in metres, must be"),
        ("[jitter]\nturn = 1", "jitter has no 'turn'"),
        ("jitter = 1", "jitter must be a table"),
        ("counts = [", "is not valid TOML"),
    ],
)
def test_mistakes_are_told_in_a_line(tmp_path: Path, text: str, told: str) -> None:
    path = tmp_path / "vary.toml"
    path.write_text(text)
    with pytest.raises(UniSGError, match=told) as error:
        read_record(path)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(UniSGError, match="cannot read"):
        read_record(tmp_path / "none.toml")


def test_the_example_is_what_its_text_says() -> None:
    content: dict[str, Any] = tomllib.loads((EXAMPLES / "variations.toml").read_text())
    assert "Stool" in content["counts"]

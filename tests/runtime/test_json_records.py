"""Dataclasses as JSON records and back, and what a record is refused for."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import pytest

from unisg_blender.behaviour import motion_from_json
from unisg_blender.errors import UniSGError
from unisg_blender.runtime.json_records import check_version, from_record, parse_json, to_record
from unisg_blender.scene import ActionData, LessonNode, SceneBuilder, Thresholds
from unisg_blender.scene.action_data import actions_from_json, actions_to_json
from unisg_blender.scene.lesson_node import lesson_from_json, lesson_to_json
from unisg_blender.scene.recording_tables import recorded_from_json
from unisg_blender.scene.relation import relations_from_json


@dataclass(frozen=True)
class Wheel:
    """A part."""

    radius: float
    spokes: int = 0


@dataclass(frozen=True)
class Cart:
    """Every kind of field."""

    uid: str
    wheels: tuple[Wheel, ...] = ()
    size: tuple[float, float] | None = None
    open: bool = False
    names: Mapping[str, str] = field(default_factory=dict)
    extra: Mapping[str, Any] = field(default_factory=dict)


def test_a_record_holds_what_is_not_default_and_comes_back() -> None:
    cart = Cart("c", (Wheel(0.5, 12), Wheel(1)), (1.0, 2.0), names={"a": "b"}, extra={"color": "red"})
    record = {
        "uid": "c", "wheels": [{"radius": 0.5, "spokes": 12}, {"radius": 1}], "size": [1.0, 2.0], "names": {"a": "b"},
        "color": "red",
    }  # fmt: skip
    assert to_record(cart) == record
    assert from_record(Cart, json.loads(json.dumps(record)), "cart") == cart
    assert to_record(Cart("c")) == {"uid": "c"}


@pytest.mark.parametrize(
    ("record", "says"),
    [
        ([], "cart must be a JSON object"),
        ({}, "cart needs 'uid'"),
        ({"uid": 3}, "cart 3: 'uid' must be a str"),
        ({"uid": "c", "open": 1}, "cart 'c': 'open' must be a bool"),
        ({"uid": "c", "size": [1]}, "cart 'c': 'size' must be a list of 2 finite number values"),
        ({"uid": "c", "size": [1, float("nan")]}, "cart 'c': 'size' must be a finite number"),
        ({"uid": "c", "wheels": {}}, "cart 'c': 'wheels' must be a list of Wheel values"),
        ({"uid": "c", "wheels": [{}]}, "cart 'c': 'wheels' needs 'radius'"),
        ({"uid": "c", "wheels": [{"radius": True}]}, "cart 'c': 'wheels': 'radius' must be a finite number"),
        ({"uid": "c", "wheels": [{"radius": 1, "rim": 2}]}, "cart 'c': 'wheels' may have radius, spokes, not 'rim'"),
        ({"uid": "c", "wheels": [{"radius": 1, "spokes": 1.5}]}, "cart 'c': 'wheels': 'spokes' must be an int"),
        ({"uid": "c", "names": {"a": 1}}, "cart 'c': 'names' must be a str"),
        ({"uid": "c", "names": []}, "cart 'c': 'names' must be an object of str values"),
    ],
)
def test_what_is_wrong_with_a_record_is_said_in_one_line(record: Any, says: str) -> None:
    with pytest.raises(UniSGError) as error:
        from_record(Cart, record, "cart")
    assert str(error.value) == says


@pytest.mark.parametrize("version", [2, "1", None, 1.5])
def test_unknown_versions_are_refused(version: object) -> None:
    with pytest.raises(UniSGError, match=r"this cart has version .*; this software reads up to 1: update it"):
        check_version(version, "this cart has", 1)


BAD = {
    "deep lists": "[" * 1000 + "]" * 1000,
    "very deep lists": "[" * 100_000 + "]" * 100_000,
    "deep objects": '{"a":' * 500 + "1" + "}" * 500,
    "long integer": "1" + "0" * 400,
    "very long integer": "1" + "0" * 5000,
    "no end": "{",
    "not UTF-8": b'"\xff"',
}


@pytest.mark.parametrize("text", BAD.values(), ids=BAD)
def test_texts_that_no_program_should_be_given_are_refused(text: str | bytes) -> None:
    with pytest.raises(UniSGError, match=r"^the text is not valid JSON: "):
        parse_json(text, "the text")


def test_brackets_in_strings_are_no_levels() -> None:
    value = ["[" * 500, '"' + "{" * 500, "\\" * 7]
    assert parse_json(json.dumps(value), "it") == value
    many = [[number, {"a": "]"}] for number in range(500)]
    assert parse_json(json.dumps(many), "it") == many


DOORS: dict[str, Callable[[str], Any]] = {
    "actions": actions_from_json,
    "lesson": lesson_from_json,
    "relations": relations_from_json,
    "recording": recorded_from_json,
    "motion": lambda text: motion_from_json(SceneBuilder().build(), text),
}


@pytest.mark.parametrize("read", DOORS.values(), ids=DOORS)
@pytest.mark.parametrize(
    "text",
    [
        BAD["deep lists"],
        '{"kind": "operation", "uid": "o", "children": ' + BAD["deep lists"] + "}",
        '[{"uid": "a", "type": "Use", "thresholds": {"distance": ' + BAD["long integer"] + "}}]",
        '{"version": ' + BAD["long integer"] + "}",
        '{"times": [' + BAD["long integer"] + '], "rate": ' + BAD["long integer"] + "}",
        "3",
        '{"version": 99, "kind": "operation", "relations": []}',
    ],
    ids=["deep", "deep inside", "long number", "long version", "long times", "no object", "version"],
)
def test_every_door_answers_bad_texts_with_one_line(read: Callable[[str], Any], text: str) -> None:
    with pytest.raises(UniSGError) as error:
        read(text)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"reference": [1.0] * 15}, "action 'a': 'reference' must be 16 finite numbers, a 4x4 matrix row by row"),
        ({"reference": [1.0] * 16}, "action 'a': the last row of 'reference' must be 0 0 0 1"),
        ({"thresholds": {"hold": -1}}, "action 'a': threshold 'hold' must be a number that is not negative"),
        (
            {"thresholds": {"holt": 1}},
            "action 'a': 'thresholds' may have angle, distance, force, hits, hold, not 'holt' (did you mean 'hold'?)",
        ),
        ({"mode": "some"}, "action 'a': 'mode' must be 'all' or 'any'"),
        ({"targets": "x"}, "action 'a': 'targets' must be a list of str values"),
        ({"correct": [True]}, "action 'a': 'correct' must be an int"),
        ({"version": 2}, "action 'a' has version 2; this software reads up to 1: update it"),
    ],
)
def test_actions_that_cannot_be_are_refused(change: dict[str, Any], says: str) -> None:
    with pytest.raises(UniSGError) as error:
        actions_from_json(json.dumps([{"uid": "a", "type": "Use"} | change]))
    assert str(error.value) == says


def test_the_texts_of_actions_and_lessons_are_what_they_were() -> None:
    action = ActionData("a", "Use", targets=("t",), thresholds=Thresholds(hold=2, hits=3), extra={"new": [1]})
    text = (
        '[{"new": [1], "targets": ["t"], "thresholds": {"hits": 3, "hold": 2}, "type": "Use", "uid": "a", '
        '"version": 1}]'
    )
    assert actions_to_json([action]) == text
    assert actions_from_json(text) == (action,)
    lesson = LessonNode("operation", "o", children=(LessonNode("lesson", "l", "L", optional=True, requires=("x",)),))
    text = (
        '{"children": [{"kind": "lesson", "name": "L", "optional": true, "requires": ["x"], "uid": "l"}], '
        '"kind": "operation", "uid": "o", "version": 1}'
    )
    assert lesson_to_json(lesson) == text
    assert lesson_from_json(text) == lesson


@pytest.mark.parametrize(
    ("child", "says"),
    [
        ({"kind": "action", "uid": "x"}, "operation 'o' cannot hold the action 'x'"),
        ({"kind": "chapter", "uid": "x"}, "lesson node 'x': 'kind' must be one of operation, lesson, stage, action"),
        ({"kind": "lesson"}, "lesson node 'o': 'children' needs 'uid'"),
    ],
)
def test_lessons_that_cannot_be_are_refused(child: dict[str, Any], says: str) -> None:
    with pytest.raises(UniSGError) as error:
        lesson_from_json(json.dumps({"kind": "operation", "uid": "o", "children": [child]}))
    assert str(error.value) == says

"""What finds no place says why, and many alike are not tried for ever."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.generate.rooms import at, box
from unisg_blender.generate import Generator
from unisg_blender.generate.check.settled_scene import settle_rows
from unisg_blender.generate.place import placer
from unisg_blender.scene import SceneBuilder

TILTED = np.array([[0.8, 0, -0.6, 0], [0, 1, 0, 0], [0.6, 0, 0.8, 1.0], [0, 0, 0, 1]])


def note_of(room: float, crate: tuple[float, float, float], *others: tuple[str, np.ndarray, tuple]) -> str:
    """What is said of a crate of a size in the middle of a square room, 3 m up, among other things."""
    builder = SceneBuilder("Room")
    floor = builder.add("Floor", uid="f", local=at(0, 0, -0.1), mesh=box("Floor", room, room, 0.1), category="Floor")
    for name, local, size in others:
        builder.add(name, uid=name, parent=floor, local=local, mesh=box(name, *size), category=name)
    builder.add("Crate", uid="c", parent=floor, local=at(0, 0, 3), mesh=box("Crate", *crate), category="Crate")
    graph = builder.build()
    (item,) = settle_rows(graph, [graph.row_of_uid["c"]])
    return item.note


def test_a_tilted_board_holds_nothing() -> None:
    note = note_of(1, (0.8, 0.8, 1.2), ("Board", TILTED, (1.5, 1.5, 0.02)))
    assert note == "no free place was found: Board is tilted, nothing of it is level"


def test_what_is_larger_than_what_holds_it_is_told_so() -> None:
    post, wall = ("Post", at(0, 0, 0.1), (0.3, 0.3, 0.5)), (0.1, 3, 2)
    note = note_of(1, (1, 1, 0.3), post, ("Left", at(-0.4, 0, 0.1), wall), ("Right", at(0.4, 0, 0.1), wall))
    assert note == "no free place was found: it is larger than what is level of Post"


def test_what_does_not_go_into_the_room_is_told_so() -> None:
    assert note_of(1, (1.5, 1.5, 0.3)) == "no free place was found: on Floor it would reach out of the room"


def test_what_is_full_is_told_so() -> None:
    others = [(f"Table {n}", at(x, 0, 0.1), (0.4, 1, 2.5)) for n, x in enumerate((-0.35, 0.35))]
    assert note_of(1.2, (0.5, 0.9, 0.3), *others) == "no free place was found: other things are in the way on Floor"


def test_free_things_have_no_note() -> None:
    assert note_of(3, (0.5, 0.5, 0.3)) == ""


@pytest.mark.slow
def test_many_alike_are_refused_after_a_few_tries(model_file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tried: list[int] = []
    first_fitting = placer.first_fitting
    monkeypatch.setattr(placer, "first_fitting", lambda *args: tried.append(1) or first_fitting(*args))
    builder = SceneBuilder("Tiny")
    floor = builder.add("Floor", uid="f", local=at(0, 0, -0.1), mesh=box("Floor", 1, 1, 0.1), category="Floor")
    builder.add("Table", uid="t", parent=floor, local=at(0, 0, 0.1), mesh=box("Table", 0.9, 0.9, 0.8), category="Table")
    result = Generator.load(model_file).add(builder.build(), {"Table": 50}, seed=0)
    assert len(result.refused) == 50
    assert len(tried) == placer.TRIED * (1 + placer.OTHER_SHAPES)
    assert len({each.note for each in result.refused}) <= placer.TRIED


@pytest.mark.slow
def test_a_category_is_tried_again_when_something_was_placed(model_file: Path) -> None:
    builder = SceneBuilder("Bare")
    builder.add("Floor", uid="f", local=at(0, 0, -0.1), mesh=box("Floor", 2.5, 2.5, 0.1), category="Floor")
    result = Generator.load(model_file).add(builder.build(), {"Table": 20, "Cup": 3}, seed=0)
    assert {each.category for each in result.refused} == {"Table"}
    assert result.added >= 4

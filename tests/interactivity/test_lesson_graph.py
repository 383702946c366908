"""The graph of a lesson tells what the player of lessons tells, moment by moment, and keeps the standard's rules."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from tests.behaviour.test_lesson import insert, leaf, operation, scene, shifted, stage
from tests.interactivity.graph_rules import broken_rules
from tests.interactivity.playing import BY_AXES, told_by_graph, told_by_player
from tests.interactivity.random_lessons import played_lessons
from unisg_blender.behaviour import Moment, add_type, check_scene, moment, moments, rehearse, remove_type
from unisg_blender.errors import UniSGError
from unisg_blender.interactivity import lesson_graph
from unisg_blender.scene import ActionData, SceneGraph, Thresholds, world_matrices
from unisg_blender.worlds import living_room, operating_room

COMMON, EACH = 27_000, 5_600
"""Bytes of a graph: what all have, and what is for each action."""


@pytest.mark.slow
@settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.filter_too_much, HealthCheck.too_slow])
@given(played_lessons())
def test_random_lessons_are_told_alike(played: tuple[SceneGraph, list[Moment]]) -> None:
    graph, moments_ = played
    assume(not any(problem.severe for problem in check_scene(graph)))
    compiled = lesson_graph(graph)
    assert told_by_graph(compiled, moments_) == told_by_player(compiled, moments_)
    assert broken_rules(compiled.graph, len(graph)) == []


@pytest.mark.slow
@settings(max_examples=3, deadline=None)
@given(st.integers(0, 5000))
def test_rehearsals_of_operating_rooms_are_told_alike(seed: int) -> None:
    compiled = lesson_graph(operating_room(seed))
    steps = list(moments(compiled.lesson.graph, rehearse(compiled.lesson)))
    assert told_by_graph(compiled, steps) == told_by_player(compiled, steps)


@settings(max_examples=3, deadline=None)
@given(st.integers(0, 5000))
def test_rehearsals_of_living_rooms_are_told_alike_and_end(seed: int) -> None:
    compiled = lesson_graph(living_room(seed))
    steps = list(moments(compiled.lesson.graph, rehearse(compiled.lesson)))
    told = told_by_graph(compiled, steps)
    assert told == told_by_player(compiled, steps)
    assert ("unisg:performed", 0) in [event for each in told for event in each]


@settings(max_examples=8, deadline=None)
@given(st.integers(0, 5000))
def test_graphs_of_rooms_keep_the_rules_and_are_small(seed: int) -> None:
    for graph in (operating_room(seed), living_room(seed)):
        compiled = lesson_graph(graph)
        assert broken_rules(compiled.graph, len(graph)) == []
        assert len(json.dumps(compiled.graph, separators=(",", ":"))) < COMMON + EACH * len(
            compiled.lesson.checks.actions
        )


@pytest.mark.skipif("KHRONOS_GLTF" not in os.environ, reason="KHRONOS_GLTF names no clone of KhronosGroup/glTF")
@pytest.mark.parametrize("world", [operating_room, living_room])
def test_graphs_fit_the_schema_of_the_standard(world) -> None:
    jsonschema, referencing = pytest.importorskip("jsonschema"), pytest.importorskip("referencing")
    root = Path(os.environ["KHRONOS_GLTF"])
    own = (root / "extensions/2.0/Khronos/KHR_interactivity/schema").glob("*.json")
    known = [json.loads(path.read_text()) for path in (*own, *(root / "specification/2.0/schema").glob("*.json"))]
    registry = referencing.Registry().with_resources(
        (schema["$id"], referencing.Resource.from_contents(schema)) for schema in known
    )
    schema = registry.contents("glTF.KHR_interactivity.schema.json")
    jsonschema.Draft202012Validator(schema, registry=registry).validate({"graphs": [lesson_graph(world(3)).graph]})


def test_the_same_lesson_is_the_same_graph() -> None:
    assert lesson_graph(living_room(3)).graph == lesson_graph(living_room(3)).graph


def test_where_nothing_is_near_a_tick_does_little() -> None:
    compiled = lesson_graph(
        scene(operation(stage("s", leaf("a"))), insert("a", "thing", shifted(1.0)), thing=shifted())
    )
    graph = compiled.lesson.graph
    steps = [moment(graph, time, world_matrices(graph)) for time in (0.0, 0.1)]
    told = told_by_graph(compiled, steps)
    assert [event for event, _ in told[0]] == ["unisg:started"] * 4
    assert told[1] == []


def test_an_insert_in_a_moving_frame_has_to_be_held() -> None:
    action = ActionData(
        "a", "Insert", targets=("peg",), frame="hole", reference=tuple(shifted(0.1).ravel()),
        thresholds=Thresholds(distance=0.02, angle=0.2, hold=0.3),
    )  # fmt: skip
    graph = scene(operation(stage("s", leaf("a"))), action, peg=shifted(), hole=shifted(1.0))
    compiled = lesson_graph(graph)
    peg, hole = graph.row_of_uid["peg"], graph.row_of_uid["hole"]
    turn = np.array([[0.0, -1, 0, 0], [1, 0, 0, 3], [0, 0, 1, 0], [0, 0, 0, 1]])
    world = world_matrices(graph).copy()
    world[hole] = turn
    world[peg] = turn @ shifted(0.1 + 0.015)
    told = told_by_graph(compiled, [moment(graph, time, world) for time in (0.0, 0.2, 0.29, 0.31, 0.5)])
    assert [len(each) for each in told] == [4, 0, 0, 4, 0]
    world[peg] = turn @ shifted(0.1 + 0.025)
    assert not any(told_by_graph(compiled, [moment(graph, time, world) for time in (0.0, 1.0, 2.0)])[1:])


def test_an_own_type_is_confirmed_by_the_player_and_told() -> None:
    from unisg_blender.interactivity.graph_player import GraphPlayer

    add_type("Admire", lambda batch, moment: np.zeros(len(batch.actions), bool))
    try:
        graph = scene(
            operation(stage("s", leaf("a"))), ActionData("a", "Admire", "Look at it", ("thing",)), thing=shifted()
        )
        compiled = lesson_graph(graph)
    finally:
        remove_type("Admire")
    assert [name for name, _ in compiled.lost] == ["Look at it"]
    player = GraphPlayer(compiled.graph, lambda node: np.eye(4).ravel().tolist())
    player.tick(0.0)
    assert player.tick(0.1) == []
    player.send("unisg:confirm", task=0)
    assert [event for event, _ in player.tick(0.2)] == ["unisg:performed"] * 4


def test_what_graphs_say_otherwise_is_told() -> None:
    near = ActionData("a", "Use", "Warm it", ("pot",), ("lamp",), thresholds=Thresholds(distance=0.5))
    many = ActionData("b", "Question", "Which?", answers=tuple(map(str, range(40))), correct=(2,))
    compiled = lesson_graph(
        scene(operation(stage("s", leaf("a"), leaf("b"))), near, many, pot=shifted(), lamp=shifted(2.0))
    )
    assert {name for name, _ in compiled.lost} == {"Warm it", "Which?"}


def test_a_lesson_that_is_not_sound_is_refused() -> None:
    with pytest.raises(UniSGError, match="no lesson"):
        lesson_graph(living_room(1).replace(components={}))
    with pytest.raises(UniSGError, match="not in the scene"):
        lesson_graph(scene(operation(stage("s", leaf("gone"))), thing=shifted()))


def test_nearness_at_corners_is_all_that_differs_from_the_exact_distance() -> None:
    """Where boxes touch, the exact player and the graph agree."""
    compiled = lesson_graph(living_room(2))
    steps = list(moments(compiled.lesson.graph, rehearse(compiled.lesson)))
    assert told_by_player(compiled, steps, BY_AXES) == told_by_player(compiled, steps, {})

"""Babylon.js tells what the player of lessons tells, tick by tick: `make test-web`."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings

from tests.interactivity.playing import told_by_player
from tests.interactivity.random_lessons import played_lessons
from tests.web.engine_ticks import all_told_by_engine, ticks_of, told_by_engine
from unisg_blender.behaviour import Moment, check_scene, moments, rehearse
from unisg_blender.interactivity import lesson_graph
from unisg_blender.scene import SceneGraph
from unisg_blender.worlds import living_room, operating_room

PLAYER = os.environ.get("UNISG_PLAYER", "")
RANDOM = 300
"""Random lessons that are made; those that are not sound, a third of them, cannot be played."""

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not PLAYER or not shutil.which("node"), reason="needs node and `make test-web`"),
]


@pytest.mark.parametrize("graph", [living_room(1), operating_room(4)], ids=["living room", "operating room"])
def test_a_rehearsal_is_told_alike(graph: SceneGraph, tmp_path: Path) -> None:
    compiled = lesson_graph(graph)
    steps = list(moments(compiled.lesson.graph, rehearse(compiled.lesson)))
    told, milliseconds = told_by_engine(compiled, ticks_of(compiled, steps), PLAYER, tmp_path)
    assert told == told_by_player(compiled, steps)
    print(f"{len(compiled.lesson.checks.actions)} actions: a tick takes {milliseconds:.2f} ms")


@pytest.mark.timeout(900)
def test_random_lessons_are_told_alike(tmp_path: Path) -> None:
    """All types, Parallel, requirements, options; early and wrong attempts."""
    many: list[tuple[SceneGraph, list[Moment]]] = []

    @settings(max_examples=RANDOM, deadline=None, phases=[Phase.generate], suppress_health_check=list(HealthCheck))
    @given(played_lessons())
    def collect(played: tuple[SceneGraph, list[Moment]]) -> None:
        if not any(problem.severe for problem in check_scene(played[0])):
            many.append(played)

    collect()
    played = [(lesson_graph(graph), steps) for graph, steps in many]
    wanted = [told_by_player(compiled, steps) for compiled, steps in played]
    told = all_told_by_engine([(compiled, ticks_of(compiled, steps)) for compiled, steps in played], PLAYER, tmp_path)
    assert len(told) > RANDOM / 3
    assert [found for found, _ in told] == wanted


def test_selecting_a_thing_moves_it_to_its_place(tmp_path: Path) -> None:
    compiled = lesson_graph(living_room(1))
    actions, lesson = compiled.lesson.checks.actions, compiled.lesson
    task = next(task for task, action in enumerate(actions) if action.type == "Use")
    row = lesson.graph.row_of_uid[actions[task].tools[0]]
    ticks = [{"time": float(time)} for time in np.arange(0, 4, 0.016)]
    ticks[4]["selected"] = [row]
    told, _ = told_by_engine(compiled, ticks, PLAYER, tmp_path)
    assert ("unisg:performed", compiled.leaf_of(task)) in [event for each in told for event in each]

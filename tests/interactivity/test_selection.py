"""Where nothing can be dragged, selecting things is enough to perform all but Questions."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from tests.behaviour.test_lesson import insert, leaf, operation, scene, shifted, stage
from unisg_blender.behaviour import add_type, remove_type
from unisg_blender.formats.gltf.gltf_axes import parts_of
from unisg_blender.geometry.y_up import turned_matrices
from unisg_blender.interactivity import LessonGraph, lesson_graph
from unisg_blender.interactivity.graph_player import GraphPlayer, Sent
from unisg_blender.scene import ActionData, SceneGraph
from unisg_blender.worlds import living_room, operating_room

TICK = 0.1


class Viewer:
    """A viewer that knows of a lesson no more than a standard player does: things can be selected, events answered."""

    def __init__(self, compiled: LessonGraph) -> None:
        self.graph = compiled.lesson.graph
        local = turned_matrices(self.graph.local)
        translation, rotation, self.scale, _ = parts_of(local)
        self.parts = [
            {"translation": one.tolist(), "rotation": other.tolist()}
            for one, other in zip(translation, rotation, strict=True)
        ]
        self.player = GraphPlayer(
            compiled.graph, lambda row: self.world(row).T.ravel().tolist(), self.parts.__getitem__
        )
        self.time = 0.0

    def world(self, row: int) -> np.ndarray:
        matrix = np.eye(4)
        while row >= 0:
            local = np.eye(4)
            local[:3, :3] = rotated(self.parts[row]["rotation"]) * self.scale[row]
            local[:3, 3] = self.parts[row]["translation"]
            matrix, row = local @ matrix, int(self.graph.parent[row])
        return matrix

    def ticks(self, seconds: float) -> list[Sent]:
        told = []
        for _ in range(int(seconds / TICK)):
            told += self.player.tick(self.time)
            self.time += TICK
        return told


def rotated(quaternion: list[float]) -> np.ndarray:
    x, y, z, w = quaternion
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip


def open_tasks(compiled: LessonGraph, status: dict[int, str]) -> Iterator[int]:
    for task, action in enumerate(compiled.lesson.checks.actions):
        if status.get(compiled.leaf_of(task)) == "unisg:started" and action.type != "Parallel":
            yield task


def played(compiled: LessonGraph, rounds: int = 150) -> list[Sent]:
    """Every open action once and again, by selecting what it is about, until the lesson is done."""
    viewer, actions = Viewer(compiled), compiled.lesson.checks.actions
    status: dict[int, str] = {}
    told = viewer.ticks(0.3)
    seen, done = 0, set()
    for _ in range(rounds):
        for event, values in told[seen:]:
            if "node" in values:
                status[values["node"]] = event
        seen = len(told)
        if status[0] == "unisg:performed":
            break
        for task in [task for task in open_tasks(compiled, status) if task not in done]:
            action = actions[task]
            if action.type == "Question":
                viewer.player.send("unisg:answer", task=task, chosen=sum(1 << place for place in action.correct))
                told += viewer.ticks(0.2)
            else:
                about = action.tools[:1] if action.type in ("Use", "Tool") else action.targets
                for uid in about:
                    told += viewer.player.select(viewer.graph.row_of_uid[uid])
                    told += viewer.ticks(1.8 + (action.thresholds.hold or 0.0))
    return told


@pytest.mark.slow
@pytest.mark.parametrize("graph", [living_room(1), living_room(3), operating_room(0)], ids=["sofa", "other", "theatre"])
def test_a_lesson_is_played_to_its_end_by_selecting(graph: SceneGraph) -> None:
    compiled = lesson_graph(graph)
    assert ("unisg:performed", {"node": 0}) in played(compiled)


def one(action: ActionData, **things: np.ndarray) -> LessonGraph:
    return lesson_graph(scene(operation(stage("s", leaf("a"))), action, **things))


def test_a_thing_goes_to_its_place_and_an_early_one_stays() -> None:
    compiled = lesson_graph(
        scene(
            operation(stage("s", leaf("a"), leaf("b"))), insert("a", "cup", shifted(1.0)),
            insert("b", "jug", shifted(2.0)), cup=shifted(), jug=shifted(0.5),
        )
    )  # fmt: skip
    viewer = Viewer(compiled)
    viewer.ticks(0.2)
    cup, jug = (viewer.graph.row_of_uid[name] for name in ("cup", "jug"))
    viewer.player.select(jug)
    viewer.ticks(1.0)
    np.testing.assert_allclose(viewer.world(jug)[:3, 3], [0.5, 0, 0], atol=1e-9)
    viewer.player.select(cup)
    told = viewer.ticks(1.0)
    np.testing.assert_allclose(viewer.world(cup)[:3, 3], [1, 0, 0], atol=1e-9)
    assert [event for event, _ in told].count("unisg:performed") == 1


def test_where_things_are_dragged_selecting_does_nothing() -> None:
    compiled = one(insert("a", "cup", shifted(1.0)), cup=shifted())
    viewer = Viewer(compiled)
    viewer.ticks(0.2)
    viewer.player.send("unisg:dragging", possible=True)
    viewer.player.select(viewer.graph.row_of_uid["cup"])
    assert viewer.ticks(1.0) == []
    viewer.player.send("unisg:dragging", possible=False)
    viewer.player.select(viewer.graph.row_of_uid["cup"])
    assert viewer.ticks(1.0)


def test_what_has_to_be_confirmed_is_confirmed_by_selecting() -> None:
    add_type("Admire", lambda batch, moment: np.zeros(len(batch.actions), bool))
    try:
        compiled = one(ActionData("a", "Admire", "Look at it", ("cup",)), cup=shifted())
    finally:
        remove_type("Admire")
    viewer = Viewer(compiled)
    viewer.ticks(0.2)
    viewer.player.select(viewer.graph.row_of_uid["cup"])
    assert ("unisg:performed", {"node": 0}) in viewer.ticks(0.3)

"""Random lessons with actions of all types, and random play: right, wrong, early, again and again."""

from __future__ import annotations

from dataclasses import replace

import hypothesis.strategies as st
import numpy as np

from tests.behaviour.test_lesson import any_operation
from unisg_blender.behaviour import Moment, moment
from unisg_blender.scene import ActionData, LessonNode, SceneBuilder, SceneGraph, Thresholds, mesh_from_faces

THINGS = ("a", "b", "c", "d")
PLACES = 5
BOX = np.array([[x, y, z] for x in (-0.1, 0.1) for y in (-0.05, 0.05) for z in (-0.02, 0.02)])
CUBE = mesh_from_faces("Box", BOX, [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])


def turned(rng: np.random.Generator, spread: float = 0.25) -> np.ndarray:
    """A random pose: rotation and place."""
    matrix = np.eye(4)
    rotation = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    matrix[:3, :3] = rotation * np.sign(np.linalg.det(rotation))
    matrix[:3, 3] = rng.uniform(-spread, spread, 3)
    return matrix


@st.composite
def played_lessons(draw: st.DrawFn) -> tuple[SceneGraph, list[Moment]]:
    """A scene with one lesson, and moments in which its things jump between places."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    places = [turned(rng) for _ in range(PLACES)]
    root, actions = _with_actions(draw(any_operation(least=1)), rng, places)
    builder = SceneBuilder()
    builder.add("Lesson", uid="lesson", lsa=root, actions=tuple(actions))
    scale = np.diag([*rng.choice([1.0, 0.5, 2.0], 1).repeat(3), 1.0])
    for name in THINGS:
        builder.add(name, uid=name, local=places[rng.integers(PLACES)] @ scale, mesh=CUBE)
    graph = builder.build()
    return graph, _moments(graph, actions, rng, places, scale, draw(st.integers(8, 40)))


def _with_actions(
    root: LessonNode, rng: np.random.Generator, places: list[np.ndarray]
) -> tuple[LessonNode, list[ActionData]]:
    actions: list[ActionData] = []

    def filled(node: LessonNode) -> LessonNode:
        """The node with an action for each leaf."""
        action = ""
        if node.kind == "action":
            added = [random_action(f"act {len(actions)}", rng, places)]
            if rng.random() < 0.2:
                members = [random_action(f"act {len(actions)} {k}", rng, places) for k in range(rng.integers(1, 4))]
                group = ActionData(
                    added[0].uid, "Parallel", members=tuple(each.uid for each in members),
                    mode=str(rng.choice(["all", "any"])),
                )  # fmt: skip
                added = [group, *members]
            actions.extend(added)
            action = added[0].uid
        return replace(node, action=action, children=tuple(map(filled, node.children)))

    return filled(root), actions


def random_action(uid: str, rng: np.random.Generator, places: list[np.ndarray]) -> ActionData:
    """An action of any type with any of the thresholds."""
    kind = str(rng.choice(["Insert", "Insert", "Remove", "Use", "Tool", "Question"]))
    one, other = (str(name) for name in rng.choice(THINGS, 2, replace=False))
    limits = Thresholds(
        distance=0.05 if kind in ("Insert", "Remove") or rng.random() < 0.4 else None,
        angle=0.3 if rng.random() < 0.5 else None,
        hold=0.25 if rng.random() < 0.3 else None,
        hits=2 if rng.random() < 0.2 else None,
        force=2.0 if rng.random() < 0.2 else None,
    )
    if kind == "Question":
        return ActionData(uid, kind, answers=("x", "y", "z"), correct=(0, 2) if rng.random() < 0.5 else (1,))
    framed = rng.random() < 0.3
    reference = places[rng.integers(PLACES)]
    if framed:
        reference = np.linalg.inv(places[rng.integers(PLACES)]) @ reference
    given = kind == "Insert" or (kind in ("Remove", "Tool") and rng.random() < 0.5)
    return ActionData(
        uid, kind, targets=(one, *([other] if kind == "Insert" and rng.random() < 0.2 else [])),
        tools=(other,) if kind in ("Use", "Tool") else (),
        reference=(*reference[:3].ravel(), 0.0, 0.0, 0.0, 1.0) if given else None,
        frame=other if framed and kind != "Tool" else "", thresholds=limits,
        trigger=kind == "Use" and rng.random() < 0.4,
    )  # fmt: skip


def _moments(
    graph: SceneGraph, actions: list[ActionData], rng: np.random.Generator, places: list[np.ndarray],
    scale: np.ndarray, count: int,
) -> list[Moment]:  # fmt: skip
    world = graph.world.copy()
    questions = [action for action in actions if action.type == "Question"]
    found = []
    for number in range(count):
        if rng.random() < 0.8:
            name = str(rng.choice(THINGS))
            goal = places[rng.integers(PLACES)].copy()
            goal[:3, 3] += rng.normal(size=3) * 0.02
            world = world.copy()
            world[graph.row_of_uid[name]] = goal @ scale
        answers = {}
        if questions and rng.random() < 0.5:
            asked = questions[rng.integers(len(questions))]
            answers[asked.uid] = asked.correct if rng.random() < 0.6 else (0,)
        pressed = [name for name in THINGS if rng.random() < 0.5]
        force = {name: float(rng.choice([0.0, 2.0, 5.0])) for name in THINGS}
        found.append(moment(graph, number * 0.125, world, pressed, force, answers))
    return found

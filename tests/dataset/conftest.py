"""Scenes for the tests of datasets."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from unisg_blender.scene import (
    ActionData,
    LessonNode,
    Mesh,
    Relation,
    SceneBuilder,
    SceneGraph,
    Thresholds,
    mesh_from_faces,
    table,
)

CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (0.0, 1.0)])
FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def box(name: str, size: tuple[float, float, float]) -> Mesh:
    return mesh_from_faces(name, CORNERS * size, FACES)


TABLE, TOOL = box("table", (1.2, 0.6, 0.9)), box("tool", (0.15, 0.02, 0.01))


def random_affine(rng: np.random.Generator) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3] = rng.normal(size=(3, 4))
    return matrix


def lesson(action: str) -> LessonNode:
    steps = (LessonNode("action", "n-cut", action=action), LessonNode("action", "n-wipe", optional=True))
    stages = (LessonNode("stage", "n-1", "Prepare", children=steps), LessonNode("stage", "n-2", requires=("n-1",)))
    return LessonNode("operation", "n-0", children=(LessonNode("lesson", "n-l", "First", children=stages),))


def build_scene(seed: int, tools: int = 3) -> SceneGraph:
    """A scene with everything: shared meshes, shear, categories, relations, actions, a lesson, a moved entity."""
    rng = np.random.default_rng(seed)
    builder = SceneBuilder(title=f"Scene {seed}")
    desk = builder.add("Tisch ü", uid=f"{seed}-table", local=random_affine(rng), mesh=TABLE, category="Table")
    cut = ActionData(
        uid=f"{seed}-cut",
        type="Use",
        targets=(f"{seed}-table",),
        tools=(f"{seed}-0", "elsewhere"),
        reference=tuple(random_affine(rng).ravel()),
        thresholds=Thresholds(distance=0.02, hold=1.5),
    )
    for number in range(tools):
        builder.add(
            f"Tool.{number}",
            uid=f"{seed}-{number}",
            parent=desk,
            local=random_affine(rng),
            mesh=TOOL,
            category="" if number == 2 else f"Tool {(seed + number) % 4}",
            actions=(cut,) if number == 0 else (),
            relations=(Relation("on_top_of", f"{seed}-table"), Relation("near", "elsewhere")),
        )
    builder.add("Operation", uid=f"{seed}-op", lsa=lesson(cut.uid))
    graph = builder.build()
    row = graph.row("Tool.0") if tools else graph.row("Operation")
    return graph.with_component("world", table([row], matrix=random_affine(rng)[None]))


@pytest.fixture
def make_scene() -> Callable[..., SceneGraph]:
    return build_scene


@pytest.fixture
def scenes() -> list[SceneGraph]:
    return [build_scene(seed, tools=seed % 4) for seed in range(7)]

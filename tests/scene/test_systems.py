"""Systems run over a scene or a part of it; the one in the documentation is run as it stands there."""

from __future__ import annotations

import re
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from unisg_blender.generate.check.settled_scene import settle
from unisg_blender.scene import (
    ActionData,
    SceneBuilder,
    SceneGraph,
    append,
    mesh_from_faces,
    placed,
    run,
    table,
    take,
    world_matrices,
)
from unisg_blender.spatial.relation_tolerances import RelationTolerances
from unisg_blender.spatial.relations import relate
from unisg_blender.worlds import WORLDS

PAGE = Path(__file__).parents[2] / "docs" / "systems.md"
ROOM = WORLDS["operating-room"](7)
CORNERS = np.stack(np.meshgrid([-0.5, 0.5], [-0.5, 0.5], [0, 1], indexing="ij"), axis=-1).reshape(-1, 3)
CUBE = mesh_from_faces(
    "Cube", CORNERS, [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
)


def at(*place: float) -> np.ndarray:
    """A matrix that only moves, metres."""
    matrix = np.eye(4)
    matrix[:3, 3] = place
    return matrix


def test_the_documented_system_does_what_the_page_says() -> None:
    example = re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)[0]
    scope: dict[str, Any] = {"graph": ROOM}
    exec(example, scope)
    inside = {ROOM.row("Instrument Table")} | {entity.row for entity in ROOM["Instrument Table"].descendants}
    rows = np.array(sorted(inside))
    others = np.setdiff1d(np.arange(len(ROOM)), rows)
    steps = scope["graph"].local[rows, :3, 3] / 0.1
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-9)
    np.testing.assert_array_equal(scope["graph"].local[others], ROOM.local[others])
    assert not np.array_equal(scope["graph"].local[rows], ROOM.local[rows])


def test_systems_run_one_after_the_other_over_the_rows_that_there_are_then() -> None:
    seen = []

    def grow(graph: SceneGraph, rows: np.ndarray) -> SceneGraph:
        """One entity more under the first row."""
        seen.append([graph.name[row] for row in rows])
        builder = SceneBuilder()
        builder.add(f"New {len(seen)}", uid=f"n{len(seen)}")
        return append(graph, [builder.build()], [graph.uid[rows[0]]])

    builder = SceneBuilder()
    builder.add("Left", uid="l")
    builder.add("Right", uid="r")
    graph = run(builder.build(), grow, grow, root=1)
    assert seen == [["Right"], ["Right", "New 1"]]
    assert graph.name == ("Left", "Right", "New 1", "New 2")
    assert run(graph) is graph
    with pytest.raises(KeyError):
        run(graph, lambda graph, rows: take(graph, np.array([0])), grow, root=1)


def test_relations_are_computed_anew_for_some_subjects_only() -> None:
    whole = run(ROOM, relate)
    root = ROOM.row("Instrument Table")
    old = table([0, root], kind=["on_top_of", "likes"], target=["nowhere", "me"])
    part = run(ROOM.with_component("relations", old), relate, root=root)
    rows = [root, *(entity.row for entity in ROOM[root].descendants)]

    def said(graph: SceneGraph, wanted: Any) -> set[tuple[int, str, str]]:
        found = graph.components["relations"]
        entries = zip(found.rows.tolist(), found.columns["kind"], found.columns["target"], strict=True)
        return {entry for entry in entries if entry[0] in wanted}

    assert said(part, range(len(ROOM))) == said(whole, rows) | {(0, "on_top_of", "nowhere"), (root, "likes", "me")}
    far = run(ROOM, partial(relate, tolerances=RelationTolerances(beside=2.0)))
    assert len(far.components["relations"].rows) > len(whole.components["relations"].rows)


def test_settled_objects_stand_on_what_is_below_them() -> None:
    builder = SceneBuilder()
    table_row = builder.add("Table", uid="t", category="Table", mesh=CUBE)
    builder.add(
        "Box", uid="b", category="Box", parent=table_row, mesh=CUBE, local=at(0, 0, 1.3) @ np.diag([0.2, 0.2, 0.2, 1])
    )
    graph = builder.build()
    settled = run(graph, settle, root=graph.row("Box"))
    assert settled["Box"].world[2, 3] == pytest.approx(1, abs=1e-2)
    np.testing.assert_array_equal(settled["Table"].world, graph["Table"].world)
    assert settle(graph, []) is graph


def test_entities_are_placed_in_the_world_and_what_hangs_under_them_comes_along() -> None:
    builder = SceneBuilder()
    root = builder.add("A", uid="a", local=at(1, 0, 0))
    child = builder.add("B", uid="b", parent=root, local=at(0, 1, 0))
    builder.add("C", uid="c", parent=child, local=at(0, 0, 1), actions=(ActionData("x", "Use"),))
    graph = builder.build().with_component("world", table([0, 2], matrix=np.stack([at(5, 0, 0), at(9, 9, 9)])))
    moved = placed(graph, [0, 1], np.stack([at(2, 0, 0), at(2, 2, 0)]))
    assert world_matrices(moved)[:, :3, 3].tolist() == [[2, 0, 0], [2, 2, 0], [9, 9, 9]]
    assert moved.local[:2, :3, 3].tolist() == [[2, 0, 0], [0, 2, 0]]
    assert moved.components["world"].rows.tolist() == [2]
    assert placed(graph, [2], at(7, 7, 7)[None]).world[2, :3, 3].tolist() == [7, 7, 7]

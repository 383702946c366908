"""A room as a sceneState: what its file says of walls, holes, floors and things, told by hand."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.meshes.shapes import box
from unisg_blender.formats import read_scene_file, write_scene_file
from unisg_blender.geometry.planar import turn
from unisg_blender.scene import Relation, SceneBuilder


def at(x: float, y: float, z: float, yaw: float = 0.0) -> np.ndarray:
    matrix = turn(yaw)
    matrix[:3, 3] = x, y, z
    return matrix


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], list[str], Path]:
    """A floor, a turned wall with a door, one with a window, a door in no wall, a shelf with a book, an empty."""
    builder = SceneBuilder("Study")
    builder.add("Ground", uid="f", mesh=box((6, 5, 0.1), (0, 0, -0.1)), category="Floor")
    builder.add("Sky", uid="c", mesh=box((6, 5, 0.1), (0, 0, 2.8)), category="Ceiling")
    builder.add("Long", uid="w1", mesh=box((6, 0.2, 2.8)), category="Wall", local=at(0, 5, 0))
    builder.add("Deep", uid="w2", mesh=box((0.1, 5, 2.5)), category="Wall", local=at(0, 0, 0.2))
    builder.add("In", uid="d", mesh=box((0.9, 0.1, 2.0)), category="Door", local=at(2, 5.05, 0))
    builder.add("Out", uid="g", mesh=box((0.1, 1.2, 1.0)), category="Window", local=at(0, 3, 1.0))
    builder.add("Lost", uid="d2", mesh=box((0.9, 0.1, 2.0)), category="Door", local=at(2, 2, 0))
    builder.add("Past", uid="d3", mesh=box((0.9, 0.1, 2.0)), category="Door", local=at(6.2, 5.05, 0))
    builder.add("Near", uid="d4", mesh=box((0.9, 0.1, 2.0)), category="Door", local=at(4, 4.81, 0))
    builder.add("Far", uid="d5", mesh=box((0.9, 0.1, 2.0)), category="Door", local=at(4, 4.79, 0))
    shelf = builder.add("Shelf", uid="s", mesh=box((1, 0.4, 2)), category="Shelf", local=at(3, 1, 0, 0.5))
    board = builder.add("Board", uid="b", parent=shelf, mesh=box((0.9, 0.3, 0.02)), local=at(0.05, 0.05, 1))
    builder.add(
        "Book", uid="k", mesh=box((0.2, 0.15, 0.03)), category="Book", local=at(3.2, 1.3, 1.02),
        relations=(Relation("on_top_of", "b"),),
    )  # fmt: skip
    builder.add("Idea", uid="i", category="Idea", parent=board)
    path = tmp_path_factory.mktemp("state") / "room.scenestate.json"
    report = write_scene_file(builder.build(), path)
    return json.loads(path.read_text()), list(report), path


def elements(whole: dict[str, Any], kind: str) -> list[dict[str, Any]]:
    return [each for each in whole["scene"]["arch"]["elements"] if each["type"] == kind]


def test_walls_are_the_lines_through_their_middles(written: tuple[dict[str, Any], list[str], Path]) -> None:
    walls = elements(written[0], "Wall")
    found = {tuple(np.round(sorted(wall["points"]), 6).ravel()): (wall["height"], wall["depth"]) for wall in walls}
    assert {ends: tuple(np.round(size, 6)) for ends, size in found.items()} == {
        (0, 5.1, 0, 6, 5.1, 0): (2.8, 0.2),
        (0.05, 0, 0.2, 0.05, 5, 0.2): (2.5, 0.1),
    }
    (region,) = written[0]["scene"]["arch"]["regions"]
    assert sorted(region["walls"]) == sorted(wall["id"] for wall in walls)
    assert len(region["walls"]) == 2


def test_doors_and_windows_are_holes_of_the_wall_that_they_are_in(
    written: tuple[dict[str, Any], list[str], Path],
) -> None:
    long, deep = sorted(elements(written[0], "Wall"), key=lambda wall: -wall["depth"])
    sizes = []
    for hole in long["holes"]:
        low, high = hole["box"]["min"], hole["box"]["max"]
        assert hole["type"] == "Door"
        sizes.append((*np.round(np.array(low) - (0, 0), 6), *np.round(high, 6)))
    flipped = long["points"][0][0] > long["points"][1][0]
    expected = {(2.0, 0.0, 2.9, 2.0), (4.0, 0.0, 4.9, 2.0)}
    if flipped:
        expected = {(6 - b, y, 6 - a, z) for a, y, b, z in expected}
    assert {tuple(np.round(each, 6)) for each in sizes} == {tuple(np.round(each, 6)) for each in expected}
    (window,) = deep["holes"]
    assert window["type"] == "Window"
    reach = [window["box"]["min"][0], window["box"]["max"][0]]
    assert np.round(reach, 6).tolist() in ([3, 4.2], [0.8, 2.0])
    np.testing.assert_allclose([window["box"]["min"][1], window["box"]["max"][1]], [0.8, 1.8])
    left_out = [line.split(":")[0] for line in written[1] if "it is in no wall" in line]
    assert left_out == ["Far", "Lost", "Past"]


def test_slabs_are_the_faces_that_are_walked_on_or_seen(written: tuple[dict[str, Any], list[str], Path]) -> None:
    (floor,), (ceiling,) = elements(written[0], "Floor"), elements(written[0], "Ceiling")
    for slab, height in ((floor, 0.0), (ceiling, 2.8)):
        points = np.array(slab["points"])
        assert points.shape == (4, 3)
        np.testing.assert_allclose(points[:, 2], height, atol=1e-6)
        np.testing.assert_allclose([points.min(axis=0)[:2], points.max(axis=0)[:2]], [[0, 0], [6, 5]], atol=1e-6)


def test_things_are_models_with_their_parts_and_what_holds_them(
    written: tuple[dict[str, Any], list[str], Path],
) -> None:
    book, shelf = written[0]["scene"]["object"]
    assert (book["id"], book["index"], book["parentId"]) == ("1", 0, "2")  # the board is a part of the shelf
    assert (shelf["id"], shelf["index"], shelf["parentId"]) == ("2", 1, "")
    assert any("Idea" in line and "no geometry" in line for line in written[1])
    again, _ = read_scene_file(written[2])
    row = again.name.index(next(name for name in again.name if "helf" in name))
    points = again.meshes[again.mesh[row]].points @ again.world[row, :3, :3].T + again.world[row, :3, 3]
    assert len(points) == 16
    np.testing.assert_allclose(points.max(axis=0)[2], 2.0, atol=1e-6)
    yaw = at(3, 1, 0, 0.5)
    corners = np.array([[x, y, 0, 1] for x in (0, 1) for y in (0, 0.4)]) @ yaw.T
    np.testing.assert_allclose(points.min(axis=0)[:2], corners[:, :2].min(axis=0), atol=1e-6)
    np.testing.assert_allclose(points.max(axis=0)[:2], corners[:, :2].max(axis=0), atol=1e-6)

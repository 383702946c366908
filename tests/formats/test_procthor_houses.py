"""Houses of ProcTHOR: axes, walls outside the floor, openings in the walls, what holds what; damaged files."""

from __future__ import annotations

import gzip
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.formats.reading import found_in, relations
from unisg_blender.errors import UniSGError
from unisg_blender.formats.layouts.procthor_houses import room_types
from unisg_blender.scene import SceneGraph
from unisg_blender.spatial.objects import SceneObjects, scene_objects

ASSETS = {
    "Table": [{"assetId": "t", "objectType": "DiningTable", "boundingBox": {"x": 2, "y": 0.8, "z": 1}}],
    "Cup": [{"assetId": "c", "objectType": "Cup", "boundingBox": {"x": 0.1, "y": 0.2, "z": 0.1}}],
}


def point(x: float, y: float, z: float) -> dict[str, float]:
    return {"x": x, "y": y, "z": z}


def house() -> dict[str, Any]:
    """A room of 4 m by 3 m; a table turned by a quarter with a cup on it, a window in the wall along x = 0."""
    corners = [(4, 0), (0, 0), (0, 3), (4, 3)]
    walls = [
        {"id": f"wall|1|{n}", "roomId": "room|1",
         "polygon": [point(a[0], y, a[1]) for y in (0, 2.5) for a in (p, q)]}
        for n, (p, q) in enumerate(zip(corners, corners[1:] + corners[:1], strict=True))
    ]  # fmt: skip
    cup = {"id": "cup", "assetId": "c", "position": point(1, 0.9, 1.5), "rotation": point(0, 0, 0)}
    table = {
        "id": "table",
        "assetId": "t",
        "position": point(1, 0.4, 1),
        "rotation": point(0, 90, 0),
        "children": [cup],
    }
    unknown = {"id": "x", "assetId": "unknown", "position": point(2, 0, 2), "rotation": point(0, 0, 0)}
    hole = [point(0.5, 1, 0), point(1.5, 2, 0)]
    window = {"id": "w", "wall0": "wall|1|1", "holePolygon": hole}
    return {
        "rooms": [{"id": "room|1", "roomType": "Kitchen", "floorPolygon": [point(x, 0, z) for x, z in corners]}],
        "walls": walls, "doors": [], "windows": [window], "objects": [table, unknown],
    }  # fmt: skip


def write(folder: Path, *houses: dict[str, Any]) -> Path:
    (folder / "asset-database.json").write_text(json.dumps(ASSETS))
    path = folder / "houses.jsonl.gz"
    with gzip.open(path, "wt") as file:
        file.writelines(json.dumps(each) + "\n" for each in houses)
    return path


def objects_of(graph: SceneGraph) -> tuple[SceneObjects, list[str]]:
    objects = scene_objects(graph, graph.vocabulary)
    return objects, [graph.category_name(int(row)) for row in objects.row]


def test_a_house_is_read_with_its_building_and_its_supports(tmp_path: Path) -> None:
    first, second = found_in(write(tmp_path, house(), house()))
    graph = first.graph
    objects, names = objects_of(graph)
    assert room_types(graph) == "Kitchen"
    assert (graph.title, second.graph.title) == ("houses-000", "houses-001")
    assert relations(graph) == {("Cup", "on_top_of", "Dining Table")}
    assert list(first.report) == ["x: its asset is not in asset-database.json: it is left out"]
    assert sorted(names) == ["Cup", "Dining Table", "Floor", *["Wall"] * 4, "Window"]
    table, cup, floor, window = (names.index(name) for name in ("Dining Table", "Cup", "Floor", "Window"))
    np.testing.assert_allclose(objects.center[table], [1, 1, 0.4], atol=1e-6)
    reach = np.abs([np.cos(objects.yaw[table]), np.sin(objects.yaw[table])])
    np.testing.assert_allclose(reach, [0, 1], atol=1e-6)  # its two metres now lie along y
    assert objects.support[cup] == table
    assert objects.support[table] == floor
    np.testing.assert_allclose(objects.center[window], [0, 1, 1.5], atol=1e-6)
    for wall in [number for number, name in enumerate(names) if name == "Wall"]:
        out = np.abs(objects.center[wall, :2] - [2, 1.5]) - [2, 1.5]
        assert out.max() == pytest.approx(0.02)
        assert objects.bottom[wall] == pytest.approx(0)


@pytest.mark.parametrize("damage", ["text", "wall", "assets"])
def test_a_damaged_file_is_told_in_one_line(tmp_path: Path, damage: str) -> None:
    broken = house()
    broken["walls"][0]["polygon"][1] = broken["walls"][0]["polygon"][0]
    path = write(tmp_path, broken if damage == "wall" else house())
    if damage == "text":
        path.write_bytes(gzip.compress(b"{nothing"))
    if damage == "assets":
        (tmp_path / "asset-database.json").unlink()
    with pytest.raises(UniSGError, match="cannot read"):
        found_in(path)


def test_holodeck_tells_the_size_of_what_stands_on_the_floor(tmp_path: Path) -> None:
    corners = [[50, 100], [150, 100], [150, 300], [50, 300]]  # centimetres, turned by a quarter: 2 m by 1 m
    sofa = {"id": "sofa-0 (room)", "object_name": "sofa-0", "assetId": "ab12", "position": point(1, 0.4, 2)}
    sofa |= {"rotation": point(0, 90, 0), "vertices": corners}
    lamp = {**sofa, "id": "lamp|sofa-0", "position": point(1, 0.9, 2)}
    del lamp["vertices"], lamp["object_name"]
    path = tmp_path / "home.json"
    path.write_text(json.dumps(house() | {"objects": [sofa]}))
    (found,) = found_in(path)
    objects, names = objects_of(found.graph)
    sofa_number = names.index("sofa")
    np.testing.assert_allclose(objects.center[sofa_number], [1, 2, 0.4], atol=1e-6)
    np.testing.assert_allclose(2 * objects.half[sofa_number], [2, 1, 0.8], atol=1e-6)
    path.write_text(json.dumps(house() | {"objects": [sofa, lamp]}))
    with pytest.raises(UniSGError, match=r"asset-database\.json"):
        found_in(path)

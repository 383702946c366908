"""Layouts of other programs: where things are in our axes, told by hand; what is not theirs or is damaged."""

from __future__ import annotations

import gzip
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.formats.reading import bounds, found_in, relations, write, xyz
from unisg_blender.cli import main
from unisg_blender.errors import UniSGError
from unisg_blender.formats.scene_files import read_scene_file

NINETY = np.pi / 2


def internscenes() -> list[dict[str, Any]]:
    """A chair turned by a quarter about z, a picture tipped by a quarter about x."""
    return [
        {"id": 1, "category": "chair", "model_uid": "gen_assets/a", "bbox": [1, 2, 0.5, 0.4, 0.6, 1.0, NINETY, 0, 0]},
        {"id": 2, "category": "picture", "model_uid": "", "bbox": [0, 0, 1, 0.2, 0.4, 0.6, 0, NINETY, 0]},
    ]


def tdw() -> dict[str, Any]:
    """A stool, twice as long along Unity's x as its model, turned by a quarter about the axis that is up."""
    item = {"name": "stool_a", "position": xyz(1, 0, 2), "rotation": xyz(0, 90, 0), "scale_factor": xyz(2, 1, 1)}
    return {"2": {"0": [item], "1": [item, {**item, "name": "lost"}]}}


def models() -> dict[str, Any]:
    sides = {"left": xyz(-0.2, 0.2, 0), "right": xyz(0.2, 0.2, 0), "front": xyz(0, 0.2, 0.1)}
    sides |= {"back": xyz(0, 0.2, -0.1), "bottom": xyz(0, 0, 0), "top": xyz(0, 0.4, 0)}
    return {"records": {"stool_a": {"wcategory": "stool", "bounds": sides}}}


def test_boxes_of_internscenes_turn_about_z_x_and_y(tmp_path: Path) -> None:
    (found,) = found_in(write(tmp_path / "layout.json", internscenes()))
    np.testing.assert_allclose(bounds(found.graph, "chair"), [[0.7, 1.8, 0], [1.3, 2.2, 1]], atol=1e-6)
    np.testing.assert_allclose(bounds(found.graph, "picture"), [[-0.1, -0.3, 0.8], [0.1, 0.3, 1.2]], atol=1e-6)
    turned = found.graph.world[found.graph.row("chair"), :3, :3]
    np.testing.assert_allclose(turned @ (1, 0, 0), (0, 1, 0), atol=1e-9)  # its front, +x, is along +y now
    assert "CC-BY-NC-SA" in found.reader.LICENCE


def test_layouts_of_tdw_are_scenes_of_one_file(tmp_path: Path) -> None:
    write(tmp_path / "models_core.json", models())
    first, second = found_in(write(tmp_path / "plans.json", tdw()))
    np.testing.assert_allclose(bounds(first.graph, "stool"), [[0.9, 1.6, 0], [1.1, 2.4, 0.4]], atol=1e-6)
    assert [found.graph.title for found in (first, second)] == ["TDW 2-0", "TDW 2-1"]
    assert "lost: it is not in models_core.json: it is left out" in list(second.report)
    graph, _ = read_scene_file(tmp_path / "plans.json", scene="TDW 2-1")
    assert graph.title == "TDW 2-1"
    assert read_scene_file(tmp_path / "plans.json", scene="1")[0].title == "TDW 2-1"
    assert any("'TDW 2-0', the first" in line for line in read_scene_file(tmp_path / "plans.json")[1])
    with pytest.raises(UniSGError, match="no scene '9'"):
        read_scene_file(tmp_path / "plans.json", scene="9")
    (tmp_path / "models_core.json").rename(tmp_path.parent / "far.json")
    with pytest.raises(UniSGError, match=r"models_core\.json"):
        found_in(tmp_path / "plans.json")


def test_meshes_take_the_place_of_boxes(tmp_path: Path) -> None:
    """A mesh of y up, long along its z: turned so that its front is +x, then stretched to the box."""
    corners = "".join(f"v {x} {y} {z}\n" for x in (0, 1) for y in (0, 2) for z in (0, 4))
    write(tmp_path / "meshes" / "gen_assets" / "a.obj", corners + "f 1 2 4 3\nf 5 7 8 6\n")
    (found,) = found_in(write(tmp_path / "layout.json", internscenes()), tmp_path / "meshes")
    np.testing.assert_allclose(bounds(found.graph, "chair"), [[0.7, 1.8, 0], [1.3, 2.2, 1]], atol=1e-6)
    assert len(found.graph.meshes[found.graph.mesh[found.graph.row("chair")]].corners) == 12  # two faces in triangles
    with pytest.raises(UniSGError, match="no folder"):
        found_in(tmp_path / "layout.json", tmp_path / "nowhere")


def test_packed_lines_are_read_one_by_one(tmp_path: Path) -> None:
    path = tmp_path / "rooms.jsonl.gz"
    path.write_bytes(gzip.compress((json.dumps(internscenes()) + "\n\n" + json.dumps(internscenes()[:1])).encode()))
    assert [len(found.graph) for found in found_in(path)] == [2, 1]
    assert [found.graph.title for found in found_in(path)] == ["rooms-000", "rooms-001"]


def test_verbs_take_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write(tmp_path / "rooms" / "layout.json", internscenes())
    write(tmp_path / "rooms" / "notes.json", {"some": "thing"})
    write(tmp_path / "rooms" / "LICENSE", "Creative Commons Attribution-NonCommercial-ShareAlike 4.0 International")
    assert (
        main(["export", str(tmp_path / "rooms"), "--out", str(tmp_path / "data"), "-q", "--json", "--jobs", "1"]) == 0
    )
    (record,) = json.loads(capsys.readouterr().out)["records"]
    assert (record["format"], record["licence"]) == ("InternScenes layout", "CC-BY-NC-SA-4.0 (LICENSE)")
    manifest = json.loads((tmp_path / "data" / "manifest.json").read_text())
    kind = {"format": "InternScenes layout", "licence": "CC-BY-NC-SA-4.0 (LICENSE)", "files": 1, "scenes": 1}
    assert manifest["sources"] == [kind]
    assert main(["inspect", str(tmp_path / "data")]) == 0
    assert "CC-BY-NC-SA-4.0" in capsys.readouterr().out
    out = tmp_path / "layout.usda"
    assert main(["convert", str(tmp_path / "rooms" / "layout.json"), str(out), "-q"]) == 0
    assert read_scene_file(out)[0].vocabulary == ("chair", "picture")


BROKEN = {
    "not finite": [{"id": 1, "category": "a", "model_uid": "", "bbox": [1e999, 0, 0, 1, 1, 1, 0, 0, 0]}],
    "short": [{"id": 1, "category": "a", "model_uid": "", "bbox": [0, 0, 0]}],
    "words": [{"id": 1, "category": "a", "model_uid": "", "bbox": ["x"] * 9}],
    "nothing": [{"id": 1, "category": "a", "model_uid": "", "bbox": None}],
    "nested": "[" * 100_000,
    "cut": '{"nodes": [{"id"',
    "no text": "\x00\x01",
    "graph": {"nodes": [{"class_name": "a"}], "edges": []},
    "other": {"nodes": 7, "edges": []},
    "plans": {"1": {"0": [{"scale_factor": 1}]}},
    "house": {"rooms": [{"floorPolygon": []}], "walls": [], "objects": []},
    "number": 7,
}


@pytest.mark.parametrize("broken", BROKEN)
def test_what_is_damaged_is_one_line(tmp_path: Path, broken: str, capsys: pytest.CaptureFixture[str]) -> None:
    write(tmp_path / "models_core.json", models())
    path = write(tmp_path / "layout.json", BROKEN[broken])
    assert main(["inspect", str(path)]) == 1
    told = capsys.readouterr()
    assert len(told.err.splitlines()) == 1
    assert str(path) in told.err
    assert told.out == ""


def test_a_packed_file_that_is_cut_or_too_long_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = gzip.compress(json.dumps(internscenes()).encode())
    (tmp_path / "a.json.gz").write_bytes(whole[:-20])
    with pytest.raises(UniSGError, match="cannot read"):
        found_in(tmp_path / "a.json.gz")
    monkeypatch.setattr("unisg_blender.formats.layout_file.LONGEST", 100)
    (tmp_path / "a.json.gz").write_bytes(whole)
    with pytest.raises(UniSGError, match="is not read"):
        found_in(tmp_path / "a.json.gz")


def box(center: list[float], size: list[float]) -> dict[str, list[float]]:
    return {"center": center, "size": size}


def test_names_of_things_in_a_house_of_virtualhome(tmp_path: Path) -> None:
    nodes = [
        {"id": 2, "category": "Floor", "class_name": "floor", "bounding_box": box([0, 0, 0], [4, 0.1, 6])},
        {"id": 4, "category": "Props", "class_name": "desk", "bounding_box": box([1, 0.5, 2], [2, 1, 3])},
        {"id": 5, "category": "Props", "class_name": "ghost", "bounding_box": None},
    ]  # fmt: skip
    edges = [{"from_id": 4, "to_id": 2, "relation_type": "ON"}, {"from_id": 4, "to_id": 5, "relation_type": "ON"}]
    (found,) = found_in(write(tmp_path / "home.json", {"nodes": nodes, "edges": edges}))
    np.testing.assert_allclose(bounds(found.graph, "desk"), [[0, 0.5, 0], [2, 3.5, 1]], atol=1e-6)
    assert relations(found.graph) == {("desk", "on_top_of", "Floor")}

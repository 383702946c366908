"""A page of a scene: it has what browsers need, asks nobody else for anything, and no name gets out of place."""

from __future__ import annotations

import base64
import gzip
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.behaviour.test_lesson import insert, leaf, operation, scene, shifted, stage
from unisg_blender.cli import main
from unisg_blender.errors import UniSGError
from unisg_blender.formats.gltf.gltf_container import unpacked
from unisg_blender.formats.scene_files import write_scene_file
from unisg_blender.interactivity import lesson_graph
from unisg_blender.interactivity.lesson_sheet import lesson_sheet
from unisg_blender.scene import ActionData
from unisg_blender.web import write_page, write_site
from unisg_blender.web.site import NAMES
from unisg_blender.worlds import cubes, living_room, operating_room

EVIL = '</script><script>alert(1)</script> "quoted" $room'
MOST_BYTES, MOST_PACKED = 4_500_000, 1_200_000


def sheet_of(page: str) -> dict:
    return json.loads(re.findall(r'id="sheet">(.*?)</script>', page, re.DOTALL)[0])


def test_a_site_is_four_files_and_the_room_has_its_graph(tmp_path: Path) -> None:
    write_site(living_room(1), tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(NAMES)
    document, _ = unpacked((tmp_path / "room.glb").read_bytes(), "it")
    assert document["extensions"]["KHR_interactivity"]["graphs"]
    sheet = sheet_of((tmp_path / "index.html").read_text())
    assert len(sheet["names"]) == len(sheet["uids"])
    assert [node["name"] for node in document["nodes"]][: len(sheet["names"])] == sheet["names"]


def test_the_script_is_small_enough_and_nothing_outside_is_asked_for(tmp_path: Path) -> None:
    write_site(cubes(1), tmp_path)
    script = (tmp_path / "player.js").read_bytes()
    assert len(script) <= MOST_BYTES
    assert len(gzip.compress(script)) <= MOST_PACKED
    page = (tmp_path / "index.html").read_text()
    assert "http" not in page.replace("http-equiv", "")
    assert "default-src 'self'" in page
    assert "Apache License" in (tmp_path / "player-licences.txt").read_text()


def test_one_page_holds_the_room_and_the_script(tmp_path: Path) -> None:
    write_page(living_room(1), tmp_path / "room.html")
    page = (tmp_path / "room.html").read_text()
    (room,) = re.findall(r'id="room">(.*?)</script>', page, re.DOTALL)
    write_site(living_room(1), tmp_path)
    assert base64.b64decode(room) == (tmp_path / "room.glb").read_bytes()
    assert (tmp_path / "player.js").read_text()[:1000] in page


def test_a_page_without_a_lesson_says_so(tmp_path: Path) -> None:
    write_page(cubes(1), tmp_path / "cubes.html")
    write_page(living_room(1), tmp_path / "room.html")
    told = ["has no lesson" in (tmp_path / name).read_text() for name in ("cubes.html", "room.html")]
    assert told == [True, False]


def test_a_folder_with_the_name_of_a_page_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_scene_file(cubes(1), tmp_path / "cubes.json")
    words = ["web", str(tmp_path / "cubes.json"), "--out", str(tmp_path / "cubes.html")]
    assert main(words) == 1
    assert "add --single" in capsys.readouterr().err
    assert not (tmp_path / "cubes.html").exists()
    assert main([*words, "--single", "-q"]) == 0


def test_names_are_text_whatever_they_are(tmp_path: Path) -> None:
    graph = scene(
        operation(stage("s", leaf("a"))), replace(insert("a", "thing", shifted(1.0)), name=EVIL), thing=shifted()
    )
    graph = graph.replace(name=tuple(EVIL for _ in graph.name), title=EVIL)
    write_page(graph, tmp_path / "evil.html")
    page = (tmp_path / "evil.html").read_text()
    assert "<script>alert" not in page
    assert sheet_of(page)["tasks"][0]["name"] == EVIL


def test_the_sheet_says_what_actions_are_about() -> None:
    graph = operating_room(3)
    compiled = lesson_graph(graph)
    sheet = lesson_sheet(compiled)
    for record, action in zip(sheet["tasks"], compiled.lesson.checks.actions, strict=True):
        assert [sheet["uids"][row] for row in record["targets"]] == list(action.targets)
        assert sheet["parts"][record["leaf"]]["kind"] == "action"
        if action.reference is not None:
            x, y, z = np.array(action.reference).reshape(4, 4)[:3, 3]
            assert record["reference"][12:15] == [x, z, -y]
    assert all(part["parent"] < place for place, part in enumerate(sheet["parts"]))


def test_no_lesson_is_a_plain_viewer_and_one_that_is_not_sound_is_refused(tmp_path: Path) -> None:
    write_site(cubes(1), tmp_path)
    assert "parts" not in sheet_of((tmp_path / "index.html").read_text())
    broken = scene(operation(stage("s", leaf("a"))), ActionData("a", "Insert", "Put it", ("gone",)), thing=shifted())
    folder = tmp_path / "broken"
    folder.mkdir()
    with pytest.raises(UniSGError, match="not in the scene"):
        write_site(broken, folder)
    assert list(folder.iterdir()) == []


def test_the_verb_writes_both_and_keeps_what_others_made(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_scene_file(living_room(2), tmp_path / "room.json")
    source = str(tmp_path / "room.json")
    for _ in range(2):
        assert main(["web", source, "--out", str(tmp_path / "site"), "-q"]) == 0
    assert {*NAMES} <= {path.name for path in (tmp_path / "site").iterdir()}
    assert main(["web", source, "--single", "--out", str(tmp_path / "one.html"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["entities"] == len(living_room(2))
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "index.html").write_text("mine")
    assert main(["web", source, "--out", str(tmp_path / "mine")]) == 1
    assert (tmp_path / "mine" / "index.html").read_text() == "mine"
    assert main(["web", source, "--single", "--out", str(tmp_path / "one.txt")]) == 1
    assert len(capsys.readouterr().err.splitlines()) == 2

"""Pages of scenes that nobody would make on purpose, in Chromium: `make test-web`."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.behaviour.test_lesson import insert, leaf, operation, scene, shifted, stage
from tests.interactivity.random_lessons import CUBE
from tests.web.browser_runs import looked_at, needs_browser
from unisg_blender.errors import UniSGError
from unisg_blender.scene import ActionData, SceneBuilder, SceneGraph
from unisg_blender.web import write_page, write_site
from unisg_blender.worlds import cubes

EVIL = '</script><img src=x onerror="window.evil=1"><script>window.evil=1</script> "quoted" \'too\' $room {{x}}'
MANY = 10_000

pytestmark = [pytest.mark.slow, needs_browser]


def seen(folder: Path) -> dict:
    return json.loads(looked_at("hostile_test.mjs", folder).splitlines()[-1])


def evil_lesson() -> SceneGraph:
    """Names, titles, questions and answers that would be run if they were not shown as text."""
    asked = ActionData("b", "Question", EVIL, ("thing",), answers=(EVIL, "no"), correct=(1,))
    put = replace(insert("a", "thing", shifted(1.0)), name=EVIL)
    graph = scene(
        replace(operation(stage("s", leaf("a"), leaf("b"), ordered=False)), name=EVIL), put, asked, thing=shifted()
    )
    return graph.replace(name=tuple(EVIL for _ in graph.name), title=EVIL)


def test_names_and_questions_are_text(tmp_path: Path) -> None:
    write_site(evil_lesson(), tmp_path)
    found = seen(tmp_path)
    assert found["ready"] == "yes"
    assert found["evil"] is None
    assert found["images"] == 0
    assert found["title"] == EVIL
    assert EVIL in found["now"]
    write_page(evil_lesson(), tmp_path / "index.html")
    assert seen(tmp_path)["evil"] is None


def test_a_lesson_about_what_has_no_mesh_is_played(tmp_path: Path) -> None:
    graph = scene(operation(stage("s", leaf("a"))), insert("a", "thing", shifted(1.0)), thing=shifted())
    assert all(mesh < 0 for mesh in graph.mesh)
    write_site(graph, tmp_path)
    found = seen(tmp_path)
    assert found["finished"]
    assert "Finished" in found["message"]


def test_no_lesson_is_a_plain_viewer(tmp_path: Path) -> None:
    write_site(cubes(2), tmp_path)
    found = seen(tmp_path)
    assert (found["ready"], found["rest"]) == ("yes", False)
    assert "no lesson" in found["message"]


def test_an_empty_scene_is_shown(tmp_path: Path) -> None:
    write_site(SceneBuilder().build(), tmp_path)
    assert seen(tmp_path)["ready"] == "yes"


def test_ten_thousand_objects_with_a_lesson_are_shown_and_played(tmp_path: Path) -> None:
    builder = SceneBuilder()
    builder.add(
        "Lesson", uid="lesson", lsa=operation(stage("s", leaf("a"))), actions=(insert("a", "0", shifted(-1.0)),)
    )
    for k in range(MANY):
        place = np.eye(4)
        place[:3, 3] = k % 100, k // 100, 0
        builder.add(f"thing {k}", uid=str(k), local=place, mesh=CUBE)
    write_site(builder.build(), tmp_path)
    found = seen(tmp_path)
    assert found["nodes"] == MANY + 1
    assert found["finished"]


def test_a_room_that_is_torn_is_told(tmp_path: Path) -> None:
    write_site(cubes(1), tmp_path)
    room = tmp_path / "room.glb"
    room.write_bytes(room.read_bytes()[:200])
    found = seen(tmp_path)
    assert found["ready"] == "failed"
    assert "cannot be shown" in found["message"]


def test_targets_that_cannot_be_reached_are_refused(tmp_path: Path) -> None:
    gone = scene(operation(stage("s", leaf("a"))), ActionData("a", "Insert", "Put it", ("gone",)), thing=shifted())
    with pytest.raises(UniSGError, match="not in the scene"):
        write_site(gone, tmp_path)
    assert not list(tmp_path.iterdir())

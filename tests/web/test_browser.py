"""Chromium plays a lesson to its end, and ``unisg simulate`` judges alike what the page saved: `make test-web`."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

from unisg_blender.behaviour import moments, motion_from_json, prepare, simulate
from unisg_blender.web import write_site
from unisg_blender.worlds import living_room

PLAYER = os.environ.get("UNISG_PLAYER", "")
WORDS = {"done": "performed", "skipped": "skipped", "out_of_order": "early", "wrong_answer": "failed"}


@pytest.mark.slow
@pytest.mark.skipif(
    not PLAYER or not shutil.which("node") or not shutil.which(os.environ.get("CHROMIUM", "chromium")),
    reason="needs node, chromium and `make test-web`",
)
def test_a_lesson_played_in_a_browser_is_judged_alike(tmp_path: Path) -> None:
    graph = living_room(0)
    (tmp_path / "site").mkdir()
    write_site(graph, tmp_path / "site")
    words = ["node", "browser_test.mjs", str(tmp_path / "site"), str(tmp_path / "events.json")]
    played = subprocess.run(words, cwd=PLAYER, capture_output=True, text=True, timeout=280, check=False)
    assert played.returncode == 0, played.stderr
    text = (tmp_path / "events.json").read_text()
    timeline = simulate(prepare(graph), moments(graph, motion_from_json(graph, text)))
    assert timeline.finished
    found = [(WORDS[event.kind], event.name) for event in timeline.events if event.action and event.kind in WORDS]
    told = [(event["kind"], event["name"]) for event in json.loads(text)["events"] if event["kind"] != "started"]
    assert found == told[: len(found)]
    assert [kind for kind, _ in found].count("failed") >= 1

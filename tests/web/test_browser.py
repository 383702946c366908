"""Chromium plays lessons to their ends, and ``unisg simulate`` judges alike what the page saved: `make test-web`."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.web.browser_runs import looked_at, needs_browser
from unisg_blender.behaviour import moments, motion_from_json, prepare, simulate
from unisg_blender.scene import SceneGraph
from unisg_blender.web import write_site
from unisg_blender.worlds import living_room, operating_room

WORDS = {"done": "performed", "skipped": "skipped", "out_of_order": "early", "wrong_answer": "failed"}


@pytest.mark.slow
@pytest.mark.timeout(900)
@needs_browser
@pytest.mark.parametrize(
    ("graph", "hands"), [(operating_room(4), "mouse"), (living_room(0), "keys")], ids=["mouse", "keys"]
)
def test_a_lesson_played_in_a_browser_is_judged_alike(graph: SceneGraph, hands: str, tmp_path: Path) -> None:
    (tmp_path / "site").mkdir()
    write_site(graph, tmp_path / "site")
    printed = looked_at("browser_test.mjs", tmp_path / "site", tmp_path / "events.json", hands)
    assert json.loads(printed.splitlines()[-1])["dragged"] == (hands == "mouse")
    text = (tmp_path / "events.json").read_text()
    timeline = simulate(prepare(graph), moments(graph, motion_from_json(graph, text)))
    assert timeline.finished
    found = [(WORDS[event.kind], event.name) for event in timeline.events if event.action and event.kind in WORDS]
    told = [(event["kind"], event["name"]) for event in json.loads(text)["events"] if event["kind"] != "started"]
    assert found == told[: len(found)]
    kinds = [kind for kind, _ in found]
    assert kinds.count("failed") >= 1
    assert hands == "keys" or kinds.count("early") >= 1

"""Recordings with their events: through USD, .blend and custom properties, and played again."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from unisg_blender.behaviour import (
    PoseRecorder,
    moments,
    prepare,
    recorded_inputs,
    recorded_motion,
    rehearse,
    simulate,
    with_events,
)
from unisg_blender.behaviour.record.pose_recorder import as_blender_does
from unisg_blender.behaviour.record.recorded_events import WORDS, new_inputs
from unisg_blender.cli import main
from unisg_blender.errors import UniSGError
from unisg_blender.scene import local_matrices
from unisg_blender.scene.hierarchy import world_matrices
from unisg_blender.scene.recording_tables import Recorded, recorded_from_json, recorded_of, recorded_to_json
from unisg_blender.usd import read_usd, write_usd

spec = importlib.util.spec_from_file_location("surgery", Path(__file__).with_name("test_simulate.py"))
surgery_module = importlib.util.module_from_spec(spec)
spec.loader.exec_module(surgery_module)


@pytest.fixture(scope="module")
def graph():
    return surgery_module.surgery()


@pytest.fixture(scope="module")
def recorded(graph):
    """The surgery with the recording of a rehearsal, made as ``unisg simulate --record`` makes it."""
    lesson, recorder = prepare(graph), PoseRecorder()
    inputs, seen = [], [None]

    def watch(now, state):
        recorder.look(graph.uid, local_matrices(graph, now.world), now.time)
        inputs.extend(new_inputs(lesson, seen[0], now))
        seen[0] = now

    timeline = simulate(lesson, moments(graph, rehearse(lesson, 10.0)), watch)
    return with_events(recorder.recorded(graph), timeline.events, inputs), timeline


def events_of(graph):
    found = graph.components["events"]
    return sorted(
        (round(float(time), 6), word, action, graph.uid[row])
        for row, time, word, action in zip(
            found.rows, *(found.columns[k] for k in ("time", "event", "action")), strict=True
        )
    )


def performed(graph):
    lesson = prepare(graph)
    timeline = simulate(lesson, moments(graph, recorded_motion(graph, 10.0)))
    return timeline.finished, [event.action for event in timeline.performed()]


def test_a_recording_holds_what_was_performed_and_plays_again(recorded):
    graph, timeline = recorded
    words = [word for _, word, _, _ in events_of(graph)]
    assert words.count("performed") == len(timeline.performed()) == 8
    assert {"started", "pressed", "released", "answered:1", "force:2"} <= set(words)
    assert set(WORDS.values()) >= {word for word in words if ":" not in word} - {"pressed", "released"}
    clip = graph.components["recording"]
    assert {graph.uid[row] for row in clip.rows} >= {"scalpel", "mallet", "implant", "needle", "mask", "gown", "lamp"}
    assert sum(map(len, clip.columns["times"])) < 200  # what other keyframes imply is left out
    assert performed(graph) == (True, [event.action for event in timeline.performed()])


@pytest.mark.parametrize("ending", ["usda", "usdc"])
def test_events_are_time_samples_in_usd(recorded, tmp_path, ending):
    graph, timeline = recorded
    path = tmp_path / f"recorded.{ending}"
    write_usd(graph, path)
    again = read_usd(path)
    assert events_of(again) == events_of(graph)
    assert performed(again) == (True, [event.action for event in timeline.performed()])
    if ending == "usda":
        assert "unisg:events.timeSamples" in path.read_text()


def test_a_blend_file_keeps_recordings_as_custom_properties(recorded, tmp_path):
    pytest.importorskip("bpy")
    from unisg_blender.formats.scene_files import read_scene_file, write_scene_file

    graph, timeline = recorded
    write_scene_file(graph, tmp_path / "recorded.blend")
    again, _ = read_scene_file(tmp_path / "recorded.blend")
    assert events_of(again) == events_of(graph)
    for row in graph.components["recording"].rows:
        first, second = recorded_of(graph, row), recorded_of(again, again.row_of_uid[graph.uid[row]])
        assert np.array_equal(first.times, second.times)
        assert np.array_equal(first.matrices, second.matrices)
    assert performed(again) == (True, [event.action for event in timeline.performed()])


@pytest.mark.slow
def test_simulate_writes_a_recording_that_simulate_plays(graph, tmp_path, capsys):
    write_usd(graph, tmp_path / "surgery.usda")
    words = ["simulate", "-q", "--json", str(tmp_path / "surgery.usda")]
    assert main([*words, "--rehearse", "--rate", "10", "--record", str(tmp_path / "recorded.usdc")]) == 0
    first = json.loads(capsys.readouterr().out)
    assert main(["simulate", "-q", "--json", str(tmp_path / "recorded.usdc"), "--rate", "10"]) == 0
    second = json.loads(capsys.readouterr().out)
    assert first["finished"] and second["finished"]  # noqa: PT018
    order = [[node["uid"] for node in sorted(each["nodes"], key=lambda node: node["done"])] for each in (first, second)]
    assert order[0] == order[1]
    assert main([*words, "--rehearse", "--record", str(tmp_path / "recorded.txt")]) == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["recorded.usdc", "surgery.usda"]


NUMBER = st.floats(-1e6, 1e6)
EVENT = st.tuples(NUMBER, st.sampled_from(["performed", "pressed", "answered:0,2", "force:5"]), st.text(max_size=5))


@pytest.mark.slow
@given(st.lists(NUMBER, unique=True, max_size=5), st.lists(EVENT, max_size=5), st.integers(0, 99))
@settings(max_examples=60, deadline=None)
def test_json_keeps_every_bit(times, events, seed):
    matrices = np.random.default_rng(seed).normal(size=(len(times), 4, 4))
    matrices[:, 3] = 0, 0, 0, 1
    before = Recorded(np.array(sorted(times)), matrices, tuple(events))
    after = recorded_from_json(recorded_to_json(before))
    assert np.array_equal(after.times, before.times)
    assert np.array_equal(after.matrices, before.matrices)
    assert after.events == before.events


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[", "not valid JSON"),
        ("[]", "not of the form"),
        ('{"times": [0], "poses": [[1, 2]]}', "not of the form"),
        ('{"times": [1, 0], "poses": [[1,0,0,0,0,1,0,0,0,0,1,0],[1,0,0,0,0,1,0,0,0,0,1,0]]}', "ascending"),
        ('{"times": [NaN], "poses": [[1,0,0,0,0,1,0,0,0,0,1,0]]}', "finite"),
        ('{"version": 2}', "update it"),
        ('{"events": [["x", "y"]]}', "not of the form"),
    ],
)
def test_what_is_no_recording_is_refused(text, message):
    with pytest.raises(UniSGError, match=message):
        recorded_from_json(text)


def test_words_of_other_tools_are_no_inputs(graph):
    from unisg_blender.scene.recording_tables import event_table

    words = ["force:much", "answered:x", "danced", "pressed"]
    found = graph.with_component("events", event_table((1, (float(at), word, "")) for at, word in enumerate(words)))
    assert [(each.time, each.trigger) for each in recorded_inputs(found)] == [(3.0, True)]


def test_local_matrices_undo_world_matrices(graph):
    assert np.allclose(local_matrices(graph, world_matrices(graph)), graph.local, atol=1e-12)
    flat = world_matrices(graph).copy()
    flat[graph.row("Tray"), :3, :3] = 0
    assert np.isfinite(local_matrices(graph, flat)).all()


def test_what_comes_while_recording_is_looked_at_from_then_on():
    recorder = PoseRecorder()
    poses = np.tile(np.eye(4), (2, 1, 1))
    recorder.look(("a",), poses[:1], 0.0)
    moved = poses.copy()
    moved[:, 0, 3] = 1
    assert recorder.look(("a", "b"), moved, 1.0) == 1
    moved[1, 0, 3] = 2
    assert recorder.look(("b", "a"), moved[::-1], 2.0) == 1
    assert {uid: [time for time, _ in clip] for uid, clip in recorder.poses.items()} == {
        "a": [0.0, 1.0],
        "b": [1.0, 2.0],
    }


@pytest.mark.parametrize("degrees", [30.0, 100.0, 170.0])
def test_between_two_keys_blender_turns_the_shorter_way(degrees: float) -> None:
    """Whatever the signs of their quaternions: those of 170 and -170 degrees point apart."""

    def turned(angle: float) -> np.ndarray:
        """Features of a turn about Z."""
        half = np.radians(angle) / 2
        return np.array([1.0, 2.0, 3.0, np.cos(half), 0.0, 0.0, np.sin(half)])

    half_way = as_blender_does(turned(degrees), turned(-degrees), np.array(0.5), "quaternion")
    expected = turned(0.0) if degrees < 90 else turned(180.0)
    np.testing.assert_allclose(half_way[:3], expected[:3], atol=1e-12)
    assert abs(half_way[3:] @ expected[3:]) == pytest.approx(1)

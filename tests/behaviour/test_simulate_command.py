"""``unisg simulate`` as a user calls it."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path

import pytest

from unisg_blender.behaviour import moments, prepare, rehearse
from unisg_blender.cli import main
from unisg_blender.scene.component_table import table
from unisg_blender.usd import write_usd

spec = importlib.util.spec_from_file_location("surgery", Path(__file__).with_name("test_simulate.py"))
surgery_module = importlib.util.module_from_spec(spec)
spec.loader.exec_module(surgery_module)


@pytest.fixture(scope="module")
def graph():
    return surgery_module.surgery()


@pytest.fixture
def file(graph, tmp_path):
    path = tmp_path / "surgery.usda"
    write_usd(graph, path)
    return path


def simulate(capsys, *words):
    status = main(["simulate", "-q", *map(str, words)])
    out, err = capsys.readouterr()
    return status, out, err


def test_a_rehearsal_writes_a_timeline_a_picture_and_a_script_that_plays_again(file, tmp_path, capsys):
    out = tmp_path / "out"
    status, text, _ = simulate(capsys, file, "--rehearse", "--rate", "5", "--out", out, "--json")
    assert status == 0
    record = json.loads(text)
    assert record["finished"]
    assert json.loads((out / "timeline.json").read_text()) == record
    assert (out / "timeline.png").read_bytes().startswith(b"\x89PNG")
    assert sorted(path.name for path in out.glob("[!.]*")) == ["motion.json", "timeline.json", "timeline.png"]
    status, text, _ = simulate(capsys, file, "--motion", out / "motion.json", "--json")
    assert status == 0
    assert json.loads(text)["finished"]


def test_a_recording_in_the_file_is_played(graph, tmp_path, capsys):
    motion = rehearse(prepare(graph), 5)
    recording = table(
        [graph.row_of_uid[track.uid] for track in motion.tracks],
        times=[track.times for track in motion.tracks],
        matrices=[track.matrices for track in motion.tracks],
    )
    path = tmp_path / "recorded.usda"
    write_usd(graph.with_component("recording", recording), path)
    status, text, _ = simulate(capsys, path, "--json", "--rate", "5")
    assert status == 0
    done = [event["action"] for event in json.loads(text)["events"] if event["kind"] == "done" and event["action"]]
    assert done == ["turn"]  # a recording of poses has no answers
    assert len(list(moments(graph, motion))) > 10


@pytest.mark.parametrize(
    ("words", "status", "message"),
    [
        ([], 1, "nothing moves in"),
        (["--lesson", "Zzz", "--rehearse"], 1, "has no lesson 'Zzz'; it has: 'Knee'"),
        (["--motion", "missing.json"], 1, "cannot read missing.json"),
        (["--render", "--rehearse"], 2, "--render needs --out"),
        (["--rate", "0", "--rehearse"], 1, "--rate: must be"),
        (["--rehearse", "--motion", "x.json"], 2, "not allowed with"),
    ],
)
def test_what_cannot_be_done_is_said_and_nothing_written(file, capsys, words, status, message):
    found, out, err = simulate(capsys, file, *words)
    assert found == status
    assert message in err
    assert not out
    assert [path.name for path in file.parent.iterdir()] == ["surgery.usda"]


def test_an_unsound_lesson_is_refused_with_the_objects_name(graph, tmp_path, capsys):
    path = tmp_path / "broken.usda"
    keep = [row for row in range(len(graph)) if graph.name[row] != "Scalpel"]
    from unisg_blender.scene import take

    write_usd(take(graph, keep), path)
    status, _, err = simulate(capsys, path, "--rehearse")
    assert status == 1
    assert "Stage 'Operate' needs 'scalpel', which is not in the scene" in err


@pytest.mark.slow
def test_a_film_is_rendered(file, tmp_path, capsys, monkeypatch):
    pytest.importorskip("bpy")
    from PIL import Image

    from unisg_blender.commands import simulate as command

    monkeypatch.setattr(command, "FILM_FRAMES", 3)
    out = tmp_path / "out"
    status, _, _ = simulate(capsys, file, "--rehearse", "--rate", "5", "--out", out, "--render")
    assert status == 0
    with Image.open(out / "film.gif") as film:
        assert film.n_frames == 3
        film.seek(2)
        assert film.size == (740, 360)

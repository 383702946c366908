"""``unisg generate`` for many rooms: as one by one, whatever the kills, on a cluster too."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from tests.dask_cluster import cluster
from unisg_blender.behaviour import all_actions
from unisg_blender.cli import main
from unisg_blender.dataset import open_dataset
from unisg_blender.errors import MISUSE
from unisg_blender.formats.scene_files import read_scene_file, write_scene_file
from unisg_blender.worlds import living_room, operating_room

pytestmark = [pytest.mark.slow, pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")]
LIMIT = 100
ROOM = ["generate", "--model", "living_room", "--add", "Floor=1,Wall=4,Sofa,Cup=2"]


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def test_a_room_of_a_batch_is_that_of_a_single_call(tmp_path: Path) -> None:
    assert main([*ROOM, "--count", "2", "--seed", "3", "--format", "json", "--out", str(tmp_path / "many"), "-q"]) == 0
    single = tmp_path / "single.json"
    assert main([*ROOM, "--seed", "4", "--out", str(single), "-q"]) == 0
    assert single.read_bytes() == (tmp_path / "many" / "living_room-00004.json").read_bytes()


def test_variations_of_a_folder_of_scenes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "in").mkdir()
    for seed in (1, 2):
        write_scene_file(living_room(seed), tmp_path / "in" / f"room{seed}.usda")
    (tmp_path / "in" / "damaged.usda").write_text("#usda 1.0\n(")
    words = ["generate", "--model", "living_room", "--add", "Cup=2", "--scene", str(tmp_path / "in"), "--count", "2"]
    assert main([*words, "--format", "json", "--out", str(tmp_path / "out"), "--json", "-q"]) == 3
    report = json.loads(capsys.readouterr().out)
    assert (report["rooms"], report["failed"]) == (6, 2)
    made = [record for record in report["records"] if record["status"] == "ok"]
    assert [record["source"] for record in made] == ["room1-00000", "room1-00001", "room2-00000", "room2-00001"]
    for record in made:
        room, _ = read_scene_file(tmp_path / "out" / record["file"])
        before = living_room(1 if record["scene"] == "room1.usda" else 2)
        cups = [sum(graph.category_name(row) == "Cup" for row in range(len(graph))) for graph in (room, before)]
        assert cups[0] - cups[1] == record["added"] == 2
        assert set(before.uid) < set(room.uid)


def test_a_variation_of_a_blender_file_is_that_of_its_scenegraph(tmp_path: Path) -> None:
    """Things that are gone, moved, new or of another shape, their actions and the lesson; what is not held stays."""
    pytest.importorskip("bpy")
    base = tmp_path / "base.blend"
    write_scene_file(operating_room(1), base)
    (tmp_path / "vary.toml").write_text(
        "reroll = ['Scalpel']\nremove = ['Clamp']\nswap = ['Stool']\n[jitter]\ndistance = 0.03\nangle = 5\n"
    )
    words = ["generate", "--scene", str(base), "--vary", str(tmp_path / "vary.toml"), "-q", "--out"]
    assert main([*words, str(tmp_path / "blend")]) == 0
    assert main([*words, str(tmp_path / "json"), "--format", "json"]) == 0
    blend, _ = read_scene_file(tmp_path / "blend" / "base-00000.blend")
    graph, _ = read_scene_file(tmp_path / "json" / "base-00000.json")
    assert sorted(blend.uid) == sorted(graph.uid)
    rows = [graph.row_of_uid[uid] for uid in blend.uid]
    np.testing.assert_allclose(blend.world, graph.world[rows], atol=1e-5)
    assert sorted(all_actions(blend), key=str) == sorted(all_actions(graph), key=str)
    assert [tree for _, tree in blend.entries("lsa", "data")] == [tree for _, tree in graph.entries("lsa", "data")]
    assert set(blend.entries("relations", "kind", "target")) == {
        (blend.row_of_uid[graph.uid[row]], kind, target)
        for row, kind, target in graph.entries("relations", "kind", "target")
    }
    record = json.loads((tmp_path / "json" / "report.jsonl").read_text())
    assert min(record["removed"], record["moved"], record["added"]) > 0


def test_bad_input_of_a_batch(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = str(tmp_path / "out")
    assert main([*ROOM, "--count", "2", "--out", out, "--render", str(tmp_path / "x.png")]) == 1
    assert main([*ROOM, "--count", "2", "--out", out, "--scene", str(tmp_path / "none*.blend")]) == 1
    assert main(["generate", "--add", "Sclapel=1", "--count", "2", "--out", out]) == 1
    assert main([*ROOM, "--vary", str(tmp_path / "none.toml"), "--out", out]) == 1
    assert main([*ROOM, "--count", "0", "--out", out]) in (1, MISUSE)
    assert len(capsys.readouterr().err.splitlines()) == 5
    assert not (tmp_path / "out").exists()


def start(folder: Path, out: str, jobs: int, *more: str) -> subprocess.Popen[bytes]:
    words = [*ROOM, "--count", "40", "--format", "dataset", "--out", out, "--jobs", str(jobs), "-q", *more]
    return subprocess.Popen([sys.executable, "-m", "unisg_blender", *words], cwd=folder)


def test_kills_and_a_cluster_do_not_show(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    root = str(Path(__file__).parents[2])
    monkeypatch.setenv("PYTHONPATH", root, prepend=os.pathsep)
    assert start(tmp_path, "whole", 2).wait(LIMIT) == 0
    process = start(tmp_path, "killed", 2)
    for _ in range(5):
        time.sleep(2.0)
        process.send_signal(signal.SIGKILL)
        process.wait(LIMIT)
        process = start(tmp_path, "killed", 1, "--resume")
    assert process.wait(LIMIT) == 0
    with cluster(2, 1) as (address, workers):
        process = start(tmp_path, "cluster", 2, "--scheduler", address)
        time.sleep(6.0)
        workers[0].kill()
        assert process.wait(LIMIT) == 0
    whole = contents(tmp_path / "whole")
    assert whole == contents(tmp_path / "killed") == contents(tmp_path / "cluster")
    assert len(open_dataset(tmp_path / "whole")) == 40

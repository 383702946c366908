from __future__ import annotations

import json
import os
import subprocess
import sys

import numpy as np
import pytest

from unisg_blender.cli import main
from unisg_blender.dataset import open_dataset
from unisg_blender.errors import UniSGError
from unisg_blender.runtime.process_pool import process_pool
from unisg_blender.scene import world_matrices
from unisg_blender.usd.pxr_library import missing_pxr
from unisg_blender.worlds import living_room, operating_room

from .digest import digest


def test_json_files(tmp_path, capsys):
    assert (
        main(["world", "cubes", "--count", "2", "--seed", "3", "--out", str(tmp_path), "--format", "json", "--json"])
        == 0
    )
    report = json.loads(capsys.readouterr().out)
    assert (report["scenes"], report["seed"], len(report["files"])) == (2, 3, 2)
    record = json.loads((tmp_path / "cubes-00003.json").read_text())
    assert record["title"] == "Cubes 3"
    assert [entity["category"] for entity in record["entities"]].count("Cube") == 40
    assert sorted(path.name for path in tmp_path.glob("*.json")) == ["cubes-00003.json", "cubes-00004.json"]


@pytest.mark.slow
def test_a_dataset_is_the_same_with_one_process_and_with_two(tmp_path, capsys):
    for jobs in ("1", "2"):
        words = [
            "world",
            "living-room",
            "--count",
            "12",
            "--format",
            "dataset",
            "--form",
            "pga_even",
            "--jobs",
            jobs,
            "-q",
        ]
        assert main([*words, "--out", str(tmp_path / jobs)]) == 0
    assert capsys.readouterr().out == ""
    first, second = (open_dataset(tmp_path / jobs) for jobs in ("1", "2"))
    assert len(first) == len(second) == 12
    shards = [json.loads((tmp_path / jobs / "manifest.json").read_text())["shards"] for jobs in ("1", "2")]
    assert shards[0] == shards[1]


def test_a_dataset_with_mesh_features_and_the_numbers_of_another(tmp_path, capsys):
    first, second = str(tmp_path / "first"), str(tmp_path / "second")
    words = ["world", "cubes", "--format", "dataset", "--jobs", "1", "-q"]
    encoder = "tests.worlds.test_world_command:middle"
    assert main(["world", "living-room", *words[2:], "--out", first]) == 0
    assert main([*words, "--out", second, "--vocabulary", first, "--mesh-features", encoder]) == 0
    cubes, rooms = open_dataset(second), open_dataset(first)
    assert cubes.categories[: len(rooms.categories)] == rooms.categories
    assert "Cube" in cubes.category_counts
    assert cubes.widths["mesh_feature"] == 3
    assert main(["world", "cubes", "--format", "json", "--out", str(tmp_path / "x"), "--vocabulary", first]) == 1
    assert main([*words, "--out", str(tmp_path / "x"), "--vocabulary", str(tmp_path / "none")]) == 1
    assert main([*words, "--out", str(tmp_path / "x"), "--mesh-features", "no.such:thing"]) == 1
    assert len(capsys.readouterr().err.splitlines()) == 3
    assert not (tmp_path / "x").exists()


def middle(mesh):
    """A mesh encoder: the mean of the points."""
    return mesh.points.mean(axis=0)


def test_usd_holds_the_whole_room(tmp_path):
    if missing_pxr():
        pytest.skip(missing_pxr())
    from unisg_blender.usd import read_usd

    assert main(["world", "operating-room", "--out", str(tmp_path), "--format", "usda", "--seed", "2", "-q"]) == 0
    graph, room = read_usd(tmp_path / "operating-room-00002.usda"), operating_room(2)
    assert sorted(graph.uid) == sorted(room.uid)
    rows = [graph.row_of_uid[uid] for uid in room.uid]
    np.testing.assert_allclose(world_matrices(graph)[rows], world_matrices(room), atol=1e-6)
    assert graph.components["lsa"].columns["data"][0] == room.components["lsa"].columns["data"][0]


def test_blend_holds_the_whole_room(tmp_path):
    pytest.importorskip("bpy")
    from unisg_blender.blender import read_file

    assert main(["world", "living-room", "--out", str(tmp_path), "--seed", "1", "-q"]) == 0
    graph, _ = read_file(tmp_path / "living-room-00001.blend")
    room = living_room(1)
    rows = [graph.row_of_uid[uid] for uid in room.uid]
    np.testing.assert_allclose(world_matrices(graph)[rows], world_matrices(room), atol=1e-5)
    assert [graph.category_name(row) for row in rows] == [room.category_name(row) for row in range(len(room))]


@pytest.mark.parametrize("words", [["--count", "0"], ["--seed", "-1"], ["--jobs", "0"]])
def test_bad_numbers_write_nothing(tmp_path, capsys, words):
    out = tmp_path / "out"
    assert main(["world", "cubes", "--out", str(out), "--format", "json", *words]) == 1
    assert len(capsys.readouterr().err.strip().splitlines()) == 1
    assert not out.exists()


def test_files_are_not_replaced_unasked(tmp_path, capsys):
    words = ["world", "cubes", "--out", str(tmp_path), "--format", "json", "-q"]
    assert main(words) == 0
    before = (tmp_path / "cubes-00000.json").stat().st_mtime_ns
    assert main(words) == 1
    assert "--overwrite" in capsys.readouterr().err
    assert (tmp_path / "cubes-00000.json").stat().st_mtime_ns == before
    assert main([*words, "--overwrite"]) == 0


def test_an_unknown_world_is_misuse(capsys):
    assert main(["world", "moon", "--out", "nowhere"]) == 2
    assert "operating-room" in capsys.readouterr().err


def test_scenes_made_in_another_process_are_the_same():
    from unisg_blender.worlds import cubes
    from unisg_blender.worlds.world_batches import make_scenes

    assert digest(make_scenes(cubes, [4])[0]) == digest(make_scenes(cubes, [3, 4])[1])


SCRIPT = """
import sys
from unisg_blender import cli
from unisg_blender.worlds import WORLDS, cubes
{where}
if __name__ == "__main__":
    WORLDS["mine"] = own
    sys.exit(cli.main(["world", "mine", "--count", "25", "--jobs", "2", "--format", "json", "--out", "out", "-q"]))
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    "where", ["def own(seed): return cubes(seed)", "own = lambda s: cubes(s)", "from mine import own"]
)
def test_a_world_of_ones_own_is_made_with_several_jobs(tmp_path, where):
    """Wherever its function is: in the script, without a name, in a module that other processes can import."""
    (tmp_path / "mine.py").write_text("from unisg_blender.worlds import cubes\ndef own(seed): return cubes(seed)\n")
    (tmp_path / "script.py").write_text(SCRIPT.format(where=where))
    done = subprocess.run(
        [sys.executable, "script.py"], cwd=tmp_path, capture_output=True, text=True, timeout=200, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert len(list((tmp_path / "out").glob("*.json"))) == 25


@pytest.mark.slow
def test_a_process_that_dies_is_told_in_one_line():
    with pytest.raises(UniSGError, match="another Python process ended"), process_pool(1) as pool:
        pool.submit(os._exit, 3).result()

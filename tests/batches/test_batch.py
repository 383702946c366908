"""Batches of rooms: the same bytes whatever the jobs and interruptions, and what fails costs itself only."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from unisg_blender.batches import batch_plan
from unisg_blender.batches.batch_plan import BatchOptions, plan_rooms
from unisg_blender.batches.batch_report import REPORT
from unisg_blender.batches.batch_run import batch_steps, make_batch
from unisg_blender.dataset import open_dataset
from unisg_blender.errors import UniSGError
from unisg_blender.runtime.atomic_files import DiskFullError

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
ROOMS = plan_rooms([], 6, 0, "cubes")


@pytest.fixture
def options(tmp_path: Path) -> BatchOptions:
    """Rooms of cubes, made here."""
    settings: dict[str, Any] = {"log": str(tmp_path / "log"), "trouble": {}}
    return BatchOptions("tests.batches.makers:room", settings, "json", here=True)


def troubled(options: BatchOptions, **trouble: str) -> BatchOptions:
    """The same with trouble in rooms of some seeds, "s3" for seed 3, in processes of their own."""
    found = {name.removeprefix("s"): kind for name, kind in trouble.items()}
    return replace(options, here=False, settings=options.settings | {"trouble": found})


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def attempts(options: BatchOptions) -> list[list[str]]:
    """Seed and process of each attempt so far."""
    return [line.split() for line in Path(options.settings["log"]).read_text().splitlines()]


@pytest.mark.parametrize("kind", ["json", "dataset"])
@pytest.mark.slow
def test_jobs_and_chunks_do_not_show(
    tmp_path: Path, options: BatchOptions, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    options = replace(options, format=kind)
    make_batch(ROOMS, tmp_path / "here", options)
    make_batch(ROOMS, tmp_path / "two", replace(options, here=False), jobs=2)
    one, two = contents(tmp_path / "here"), contents(tmp_path / "two")
    assert one == two
    assert REPORT in one
    monkeypatch.setattr(batch_plan, "CHUNKS", 2)  # three rooms at a time
    make_batch(ROOMS, tmp_path / "threes", options)
    threes = contents(tmp_path / "threes")
    rooms = [name for name in one if name.startswith(("cubes-", "scenes-", "assets-"))]
    assert len(rooms) == (2 if kind == "dataset" else 6)
    assert {name: one[name] for name in rooms} == {name: threes[name] for name in rooms}


@pytest.mark.slow
def test_what_fails_costs_itself_only(tmp_path: Path, options: BatchOptions) -> None:
    bad = troubled(options, s1="refuse", s2="bug", s3="crash", s4="crash once")
    records = make_batch(ROOMS, tmp_path / "out", bad, jobs=2)
    assert [record["status"] for record in records] == ["ok", "failed", "failed", "failed", "ok", "ok"]
    reasons = [record.get("reason", "") for record in records]
    assert reasons[1:3] == ["there is no room", "ValueError: two"]
    assert "SIGSEGV" in reasons[3]
    assert [json.loads(line) for line in (tmp_path / "out" / REPORT).read_text().splitlines()] == records
    assert sorted(path.name for path in (tmp_path / "out").glob("*.json")) == [
        "cubes-00000.json", "cubes-00004.json", "cubes-00005.json",
    ]  # fmt: skip
    good = make_batch(ROOMS, tmp_path / "good", options)
    assert {key: records[4][key] for key in ("source", "seed", "entities", "cubes", "file")} == {
        key: good[4][key] for key in ("source", "seed", "entities", "cubes", "file")
    }


@pytest.mark.slow
def test_a_crash_within_a_job_leaves_the_others_of_it(
    tmp_path: Path, options: BatchOptions, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(batch_plan, "CHUNKS", 1)  # all in one job
    bad = replace(troubled(options, s2="crash", s4="crash"), format="dataset")
    records = make_batch(ROOMS, tmp_path / "out", bad, jobs=1)
    assert [record["source"] for record in records if record["status"] == "ok"] == [
        "cubes-00000", "cubes-00001", "cubes-00003", "cubes-00005",
    ]  # fmt: skip
    assert [scene.source for scene in open_dataset(tmp_path / "out")] == [
        record["source"] for record in records if record["status"] == "ok"
    ]


@pytest.mark.slow
def test_a_room_that_hangs_is_ended(tmp_path: Path, options: BatchOptions) -> None:
    bad = replace(troubled(options, s1="hang"), timeout=5.0)
    records = make_batch(ROOMS[:3], tmp_path / "out", bad, jobs=1)
    assert [record["status"] for record in records] == ["ok", "failed", "ok"]
    assert "not done after 5 s" in records[1]["reason"]


def test_what_was_made_is_not_made_again(tmp_path: Path, options: BatchOptions) -> None:
    steps = batch_steps(ROOMS, tmp_path / "out", options)
    for _ in range(4):  # the start, and three rooms
        next(steps)
    steps.close()
    assert len(attempts(options)) == 3
    with pytest.raises(UniSGError, match="unfinished batch"):
        make_batch(ROOMS, tmp_path / "out", options)
    make_batch(ROOMS, tmp_path / "out", options, resume=True)
    assert [seed for seed, _ in attempts(options)] == ["0", "1", "2", "3", "4", "5"]
    before = contents(tmp_path / "out")
    (tmp_path / "out" / "cubes-00002.json").unlink()
    make_batch(ROOMS, tmp_path / "out", options, resume=True)
    assert [seed for seed, _ in attempts(options)][6:] == ["2"]
    assert contents(tmp_path / "out") == before
    make_batch(ROOMS, tmp_path / "whole", options)
    assert contents(tmp_path / "whole") == before


@pytest.mark.parametrize("kind", ["json", "dataset"])
def test_a_finished_batch_is_resumed_without_work(tmp_path: Path, options: BatchOptions, kind: str) -> None:
    options = replace(options, format=kind)
    records = make_batch(ROOMS, tmp_path / "out", options)
    before = contents(tmp_path / "out")
    with pytest.raises(UniSGError, match="already"):
        make_batch(ROOMS, tmp_path / "out", options)
    assert make_batch(ROOMS, tmp_path / "out", options, resume=True) == records
    assert len(attempts(options)) == 6
    assert contents(tmp_path / "out") == before
    make_batch(ROOMS[:2], tmp_path / "out", options, overwrite=True)
    assert len((tmp_path / "out" / REPORT).read_text().splitlines()) == (2 if kind == "dataset" else 6)


def test_several_batches_in_one_folder(tmp_path: Path, options: BatchOptions) -> None:
    """The report has a line for each room that is there; only what would be replaced is refused."""
    rooms = plan_rooms([], 2, 3, "halls")
    bad = replace(troubled(options, s1="refuse"), here=True)
    first = make_batch(ROOMS[:2], tmp_path, bad)
    second = make_batch(rooms, tmp_path, options)
    assert [json.loads(line) for line in (tmp_path / REPORT).read_text().splitlines()] == [*first, *second]
    with pytest.raises(UniSGError, match="halls-00004"):
        make_batch(rooms[1:], tmp_path, options)
    again = make_batch(ROOMS[:2], tmp_path, options, resume=True)
    assert [json.loads(line) for line in (tmp_path / REPORT).read_text().splitlines()] == [*second, *again]
    (tmp_path / "halls-00003.json").unlink()
    make_batch(ROOMS[2:3], tmp_path, options)
    sources = [json.loads(line)["source"] for line in (tmp_path / REPORT).read_text().splitlines()]
    assert sources == ["halls-00004", "cubes-00000", "cubes-00001", "cubes-00002"]


@pytest.mark.parametrize("text", ["3\n", '{"source": "x"}\n', "{\n", "\udcff"])
def test_a_damaged_report_is_one_line(tmp_path: Path, options: BatchOptions, text: str) -> None:
    make_batch(ROOMS[:1], tmp_path, options)
    (tmp_path / REPORT).write_text(text, errors="surrogateescape")
    with pytest.raises(UniSGError, match=REPORT) as caught:
        make_batch(ROOMS[1:2], tmp_path, options)
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "cubes-00001.json").exists()


def test_files_of_others_are_not_replaced(tmp_path: Path, options: BatchOptions) -> None:
    (tmp_path / "cubes-00003.json").write_text("mine")
    for again in ({}, {"resume": True}, {"overwrite": True}):
        with pytest.raises(UniSGError, match="cubes-00003"):
            make_batch(ROOMS, tmp_path, options, **again)
    assert (tmp_path / "cubes-00003.json").read_text() == "mine"
    assert [path.name for path in tmp_path.iterdir()] == ["cubes-00003.json"]


@pytest.mark.slow
def test_a_process_that_has_used_much_memory_is_replaced(tmp_path: Path, options: BatchOptions) -> None:
    make_batch(ROOMS, tmp_path / "kept", replace(options, here=False), jobs=1)
    make_batch(ROOMS, tmp_path / "replaced", replace(options, here=False, memory=1), jobs=1)
    processes = [process for _, process in attempts(options)]
    assert (len(set(processes[:6])), len(set(processes[6:]))) == (1, 6)


def test_no_room_at_all_is_an_error(tmp_path: Path, options: BatchOptions) -> None:
    refused = replace(troubled(options, **{f"s{seed}": "refuse" for seed in range(6)}), here=True)
    with pytest.raises(UniSGError, match="none of 6 rooms could be made; cubes-00000: there is no room"):
        make_batch(ROOMS, tmp_path / "out", refused)
    assert not (tmp_path / "out").exists()  # so that the same call can be made again
    with pytest.raises(UniSGError, match=r"^cubes-00000: there is no room$"):
        make_batch(ROOMS[:1], tmp_path / "out", refused)
    assert not (tmp_path / "out").exists()


def test_a_full_disk_stops_the_batch(tmp_path: Path, options: BatchOptions, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise DiskFullError("the disk is full: no room for it")

    with monkeypatch.context() as patch:
        patch.setattr("unisg_blender.batches.room_worker.write_room", full)
        with pytest.raises(DiskFullError, match="make room, then resume"):
            make_batch(ROOMS, tmp_path / "out", options)
    assert len(make_batch(ROOMS, tmp_path / "out", options, resume=True)) == 6


def test_two_batches_into_one_folder(tmp_path: Path, options: BatchOptions) -> None:
    first = batch_steps(ROOMS, tmp_path / "out", options)
    next(first)
    with pytest.raises(UniSGError, match="wait for it, or choose another folder"):
        make_batch(ROOMS, tmp_path / "out", options)
    first.close()


def test_names_of_rooms(tmp_path: Path) -> None:
    paths = [tmp_path / name for name in ("a/room.json", "b/room.json", "b/hall.blend")]
    for path in paths:
        path.parent.mkdir(exist_ok=True)
        path.write_text("x")
    assert [task["room"] for task in plan_rooms(paths, 1, 7, "")] == [
        "a-room-json-00007", "b-room-json-00007", "hall-00007",
    ]  # fmt: skip
    with pytest.raises(UniSGError, match="cannot be read"):
        plan_rooms([tmp_path / "none.json"], 1, 0, "")

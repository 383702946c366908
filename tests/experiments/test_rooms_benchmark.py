from __future__ import annotations

import argparse
import json
from pathlib import Path

import pytest

from unisg_blender.dataset import open_dataset
from unisg_blender.errors import UniSGError
from unisg_blender.experiments.rooms import frozen_rooms as rooms_benchmark
from unisg_blender.experiments.rooms.frozen_rooms import (
    PARTS,
    FrozenPart,
    file_sums,
    scenes_digest,
    write_part,
    write_rooms,
)

SMALL = (
    FrozenPart(
        "operating-room/test",
        "operating-room",
        100_000,
        2,
        "0975f04707898d936dd1d022b0a6bf24fd9555e64b25d57596809faa4469294c",
    ),
    FrozenPart(
        "living-room/test",
        "living-room",
        100_000,
        2,
        "320c9dbb654d1d238b50b05ebc72a6c5fbfbeed6ae29801d10acba27c86f6641",
    ),
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("rooms")
    for part in SMALL:
        write_part(part, out / part.folder, lambda _: None)
    return out


@pytest.mark.parametrize("part", SMALL, ids=lambda part: part.world)
def test_the_rooms_of_the_benchmark_never_change(folder: Path, part: FrozenPart) -> None:
    """If this fails, undo what changed the worlds: numbers of other people depend on these rooms."""
    assert scenes_digest(folder / part.folder) == part.digest


def test_a_part_says_what_it_is(folder: Path) -> None:
    record = json.loads((folder / SMALL[0].folder / "part.json").read_text())
    assert (record["seed"], record["count"], record["is_version"]) == (100_000, 2, "1.0")
    assert record["sha256"] == file_sums(folder / SMALL[0].folder)
    assert len(open_dataset(folder / SMALL[0].folder)) == 2


def test_what_is_there_is_kept_and_damage_is_told(folder: Path, tmp_path: Path) -> None:
    import shutil

    copy = tmp_path / "copy"
    shutil.copytree(folder / SMALL[1].folder, copy)
    before = file_sums(copy)
    write_part(SMALL[1], copy, lambda _: None)
    assert file_sums(copy) == before
    shard = next(copy.glob("scenes-*.safetensors"))
    shard.write_bytes(shard.read_bytes()[:-1] + b"x")
    with pytest.raises(UniSGError, match="damaged"):
        write_part(SMALL[1], copy, lambda _: None)


def test_other_rooms_are_not_called_the_benchmark(tmp_path: Path) -> None:
    other = FrozenPart("x", "living-room", 7, 1, SMALL[1].digest)
    assert write_part(other, tmp_path / "x", lambda _: None)["is_version"] is None


def test_the_command_writes_all_parts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rooms_benchmark, "PARTS", SMALL[1:])
    report = write_rooms(argparse.Namespace(jobs=1), tmp_path / "out", lambda _: None)
    assert json.loads((tmp_path / "out" / "benchmark.json").read_text()) == report
    assert report["parts"]["living-room/test"]["is_version"] == report["version"]


def test_training_and_test_rooms_are_apart() -> None:
    for world in ("operating-room", "living-room"):
        seeds = [set(range(part.seed, part.seed + part.count)) for part in PARTS if part.world == world]
        assert [len(part) for part in seeds] == [1000, 300]
        assert not seeds[0] & seeds[1]


def test_training_and_test_rooms_number_names_alike(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    training = FrozenPart("living-room/training", "living-room", 0, 3, "")
    monkeypatch.setattr(rooms_benchmark, "PARTS", (training, SMALL[1]))
    write_rooms(argparse.Namespace(jobs=1), tmp_path, lambda _: None)
    one, two = (open_dataset(tmp_path / part.folder) for part in (training, SMALL[1]))
    assert two.categories[: len(one.categories)] == one.categories
    assert scenes_digest(two.path) == SMALL[1].digest

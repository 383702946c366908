"""What happens to a dataset when its export is killed, runs out of disk, meets another, or is damaged later."""

from __future__ import annotations

import errno
import io
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from unisg_blender.dataset import open_dataset, write_dataset
from unisg_blender.dataset.export.batch_export import ExportOptions, export_dataset
from unisg_blender.dataset.format import writer
from unisg_blender.errors import UniSGError
from unisg_blender.runtime import atomic_files
from unisg_blender.scene import SceneGraph

pytestmark = [pytest.mark.slow, pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")]

HERE = Path(__file__).parent
LIMIT = 250
KILLS = int(os.environ.get("UNISG_KILLS", "20"))
OPTIONS = ExportOptions(reader="fake_reader:read", timeout=60)
Make = Callable[..., SceneGraph]


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def fill(folder: Path, count: int, seconds: float = 0.0) -> Path:
    folder.mkdir()
    for number in range(count):
        (folder / f"{number:03}.obj").write_text(
            json.dumps({"seed": number, "scenes": 1 + number % 2, "seconds": seconds})
        )
    return folder


def start(source: Path, out: Path, resume: bool = False, die_at: int = 0, jobs: int = 2) -> subprocess.Popen:
    words = [str(source), str(out), str(jobs), "resume" if resume else "new", str(die_at)]
    env = os.environ | {"OMP_NUM_THREADS": "1"}
    command = [sys.executable, str(HERE / "driver.py"), *words]
    return subprocess.Popen(command, env=env, stderr=subprocess.PIPE, text=True)


def finish(process: subprocess.Popen) -> str:
    """Wait for the end; what it printed."""
    try:
        return process.communicate(timeout=LIMIT)[1]
    finally:
        process.kill()


@pytest.fixture(autouse=True)
def _fake_reader(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(HERE), prepend=os.pathsep)


def test_killed_at_random_moments_and_resumed(tmp_path: Path) -> None:
    """Kill it again and again, resume each time: the end is the same as without."""
    source, out = fill(tmp_path / "in", 60, seconds=0.05), tmp_path / "ds"
    assert finish(start(source, tmp_path / "whole")) == ""
    rng = np.random.default_rng(0)
    found = []
    for kill in range(KILLS):
        process = start(source, out, resume=kill > 0)
        wanted, deadline = parts(out) + rng.integers(0, 5), time.monotonic() + LIMIT
        while parts(out) < wanted and process.poll() is None and time.monotonic() < deadline:
            time.sleep(0.01)
        time.sleep(rng.uniform(0, 0.2))  # from the first imports to the writing of a part
        process.send_signal(signal.SIGKILL)
        finish(process)
        found.append(parts(out))
        if (out / "manifest.json").exists():  # it was done: begin again
            assert contents(out) == contents(tmp_path / "whole")
            shutil.rmtree(out)
    assert len(set(found)) > 3, found  # it was killed with part of the files read
    assert finish(start(source, out, resume=True)) == ""
    assert contents(out) == contents(tmp_path / "whole")


def parts(folder: Path) -> int:
    """How many files are read but not yet in a shard."""
    return len(list(folder.glob(".parts/*.safetensors")))


def test_killed_while_it_puts_the_shards_together(tmp_path: Path) -> None:
    """Die at each file that the exporting process itself writes: shard, assets, list of files, manifest."""
    source = fill(tmp_path / "in", 8)
    assert finish(start(source, tmp_path / "whole")) == ""
    for moment in (1, 2, 3, 4):
        out = tmp_path / f"ds{moment}"
        process = start(source, out, die_at=moment)
        finish(process)
        assert process.returncode == -signal.SIGKILL
        if moment < 4:
            with pytest.raises(UniSGError, match="holds no dataset"):
                open_dataset(out)
        with pytest.raises(UniSGError, match="unfinished export"):
            write_dataset([], out)
        assert finish(start(source, out, resume=True)) == ""
        assert contents(out) == contents(tmp_path / "whole")


def test_killed_while_it_replaces_a_dataset(tmp_path: Path) -> None:
    """The old dataset stays whole until the new one is."""
    source = fill(tmp_path / "in", 4)
    out = tmp_path / "ds"
    assert finish(start(source, out)) == ""
    for number in range(4, 6):
        (source / f"{number:03}.obj").write_text(json.dumps({"seed": number}))
    assert finish(start(source, tmp_path / "whole")) == ""
    for moment in (1, 3):
        finish(start(source, out, resume=True, die_at=moment))
        dataset = open_dataset(out)
        dataset.check()
        assert len(dataset) == 6
    assert finish(start(source, out, resume=True)) == ""
    assert contents(out) == contents(tmp_path / "whole")


def test_a_damaged_part_is_read_again(tmp_path: Path) -> None:
    source = fill(tmp_path / "in", 4)
    out = tmp_path / "ds"
    finish(start(source, out, die_at=1))
    part = sorted((out / ".parts").glob("*.safetensors"))[1]
    data = bytearray(part.read_bytes())
    data[-3] ^= 1
    part.write_bytes(data)
    assert finish(start(source, out, resume=True)) == ""
    assert len(open_dataset(out)) == 6
    open_dataset(out).check()


def test_two_exports_into_one_folder(tmp_path: Path) -> None:
    source = fill(tmp_path / "in", 6, seconds=1.0)
    first = start(source, tmp_path / "ds")
    deadline = time.monotonic() + LIMIT
    while not (tmp_path / "ds" / ".parts").exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    second = start(source, tmp_path / "ds", resume=True)
    assert "another export is writing to" in finish(second)
    assert second.returncode == 1
    assert finish(first) == ""
    assert len(open_dataset(tmp_path / "ds")) == 9


class FullDisk(io.FileIO):
    """A file on a disk that is full after some bytes."""

    room = 0

    def write(self, data: Any) -> int:
        if len(data) > FullDisk.room:
            super().write(bytes(data)[: FullDisk.room])
            raise OSError(errno.ENOSPC, "No space left on device")
        FullDisk.room -= len(data)
        return super().write(data)


@pytest.mark.parametrize("room", [0, 1000, 300_000])
def test_a_full_disk_leaves_no_half_dataset(
    tmp_path: Path, make_scene: Make, monkeypatch: pytest.MonkeyPatch, room: int
) -> None:
    monkeypatch.setattr(writer, "SCENES_PER_SHARD", 128)
    scenes = [make_scene(number) for number in range(500)]
    monkeypatch.setattr(atomic_files, "open", FullDisk, raising=False)
    monkeypatch.setattr(FullDisk, "room", room)
    with pytest.raises(UniSGError, match="the disk is full"):
        write_dataset(scenes, tmp_path / "ds")
    assert not (tmp_path / "ds").exists()


def test_a_full_disk_while_the_shards_are_put_together(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source = fill(tmp_path / "in", 5)
    export_dataset([source], tmp_path / "whole", OPTIONS)
    with monkeypatch.context() as patch:
        patch.setattr(
            atomic_files, "open", lambda path, mode="r": (FullDisk if "w" in mode else open)(path, mode), raising=False
        )
        with pytest.raises(UniSGError, match=r"the disk is full.*resume"):
            export_dataset([source], tmp_path / "ds", OPTIONS)
    assert sorted(path.name for path in (tmp_path / "ds").iterdir()) == [".parts"]
    export_dataset([source], tmp_path / "ds", OPTIONS, resume=True)
    assert contents(tmp_path / "ds") == contents(tmp_path / "whole")


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A disk of 96 KiB, where we may mount one."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mount = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=96k", "tmpfs", str(folder)], capture_output=True, timeout=20, check=False
    )
    if mount.returncode:
        pytest.skip("a tmpfs cannot be mounted here")
    yield folder
    subprocess.run(["umount", "-l", str(folder)], timeout=20, check=True)


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root may mount a tmpfs")
def test_a_disk_that_fills_up_while_files_are_read(tmp_path: Path, small_disk: Path) -> None:
    source = fill(tmp_path / "in", 30)
    with pytest.raises(UniSGError, match=r"the disk is full.*resume"):
        export_dataset([source], small_disk / "ds", OPTIONS)
    left = [path.name for path in (small_disk / "ds").rglob("*") if path.name.startswith(".") and path.is_file()]
    assert left == []
    subprocess.run(["mount", "-o", "remount,size=16m", str(small_disk)], timeout=20, check=True)
    export_dataset([source], small_disk / "ds", OPTIONS, resume=True)
    export_dataset([source], tmp_path / "whole", OPTIONS)
    assert contents(small_disk / "ds") == contents(tmp_path / "whole")


def test_a_failing_scene_leaves_no_dataset(tmp_path: Path, make_scene: Make) -> None:
    def scenes() -> Iterator[SceneGraph]:
        yield from (make_scene(number) for number in range(200))
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_dataset(scenes(), tmp_path / "ds")
    assert not (tmp_path / "ds").exists()


def test_a_process_dies_with_the_one_that_asked(tmp_path: Path) -> None:
    """A kill -9 of the export leaves no reading process behind, not even one that hangs."""
    source = fill(tmp_path / "in", 2, seconds=60)
    process = start(source, tmp_path / "ds", jobs=1)
    children: list[str] = []
    deadline = time.monotonic() + LIMIT
    while not children and time.monotonic() < deadline:
        time.sleep(0.2)
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
        children += [
            number
            for task in Path(f"/proc/{process.pid}/task").iterdir()
            for number in (task / "children").read_text().split()
        ]
    time.sleep(1.0)
    process.send_signal(signal.SIGKILL)
    finish(process)
    assert children
    while any(_runs(number) for number in children) and time.monotonic() < deadline:
        time.sleep(0.1)
    assert not any(_runs(number) for number in children)


def _runs(number: str) -> bool:
    try:
        return Path(f"/proc/{number}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False

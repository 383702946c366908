"""What is left of a verb that is stopped or killed: no process, no lock, no half file."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from unisg_blender.errors import UniSGError
from unisg_blender.runtime.folder_lock import folder_lock
from unisg_blender.runtime.process_end import signals_kept
from unisg_blender.runtime.process_pool import process_pool

LINUX = pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="looks for processes in /proc")
SECONDS = 20.0
"""How long to wait at most on a busy machine; what is not stopped works for minutes."""

WORLD = ("world", "operating-room", "--count", "2000", "--format", "dataset", "--jobs", "2", "--quiet", "--out")


def below(process: int) -> set[int]:
    """The living processes that a process has started, and those that they have."""
    parents = {}
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, parent = path.read_text().rsplit(")", 1)[1].split()[:2]
        except OSError:
            continue
        if state != "Z":
            parents[int(path.parent.name)] = int(parent)
    found: set[int] = set()
    while more := {number for number, parent in parents.items() if parent in found | {process}} - found:
        found |= more
    return found


def alive(numbers: set[int]) -> set[int]:
    """Those that still run."""
    return {number for number in numbers if number in below(1) | below(os.getpid())}


def wait_until(condition, seconds: float = SECONDS) -> None:
    end = time.monotonic() + seconds
    while not condition() and time.monotonic() < end:
        time.sleep(0.05)
    assert condition()


def stopped(words: tuple[str, ...], folder: Path, number: int, delay: float) -> subprocess.CompletedProcess[str]:
    """Send a signal to a verb when it has two other processes, and see that these end too."""
    temporary = folder / "temporary"
    temporary.mkdir()
    process = subprocess.Popen(
        [sys.executable, "-m", "unisg_blender", *words], stderr=subprocess.PIPE, text=True,
        env=os.environ | {"TMPDIR": str(temporary), "OMP_NUM_THREADS": "1"},
    )  # fmt: skip
    try:
        wait_until(lambda: len(below(process.pid)) >= 2)
        time.sleep(delay)
        children = below(process.pid)
        process.send_signal(number)
        _, errors = process.communicate(timeout=SECONDS)
        wait_until(lambda: not alive(children))
        wait_until(lambda: not list(temporary.iterdir()))
        return subprocess.CompletedProcess(words, process.returncode, "", errors)
    finally:
        process.kill()


@LINUX
@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_verb_that_is_asked_to_stop_leaves_nothing(tmp_path: Path, number: int) -> None:
    done = stopped((*WORLD, str(tmp_path / "new" / "ds")), tmp_path, number, 1.0)
    assert done.returncode == 130
    assert done.stderr.splitlines() == ["unisg world: stopped"]
    assert not (tmp_path / "new").exists()


@LINUX
@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
@pytest.mark.parametrize("delay", [0.0, 2.5])
def test_an_export_leaves_no_reading_process(tmp_path: Path, number: int, delay: float) -> None:
    """Neither one that begins nor one that reads."""
    files = tmp_path / "in"
    files.mkdir()
    (files / "0.obj").write_text("v 0 0 0\n" * 1_000_000 + "f 1 2 3\n")
    for number_of_file in range(1, 60):  # work for longer than anyone waits here
        (files / f"{number_of_file}.obj").hardlink_to(files / "0.obj")
    done = stopped(("export", str(files), "--jobs", "2", "--out", str(tmp_path / "ds"), "-q"), tmp_path, number, delay)
    if number == signal.SIGKILL:
        assert {path.name for path in (tmp_path / "ds").iterdir()} <= {".parts"}
    else:
        assert (done.returncode, done.stderr.splitlines()) == (130, ["unisg export: stopped"])
        assert not (tmp_path / "ds").exists() or list((tmp_path / "ds" / ".parts").iterdir())


@pytest.mark.slow
def test_a_pool_that_is_left_by_an_error_does_not_wait_for_its_work() -> None:
    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt), process_pool(2) as pool:  # noqa: PT012 (one pool, two steps)
        assert pool.submit(abs, -1).result() == 1
        pool.submit(time.sleep, 120)
        raise KeyboardInterrupt
    assert time.monotonic() - begin < 60


def test_a_lock_leaves_no_file_and_goes_with_its_process(tmp_path: Path) -> None:
    code = (
        "import sys, time, pathlib; from unisg_blender.runtime.folder_lock import folder_lock\n"
        f"with folder_lock(pathlib.Path({str(tmp_path)!r})): print('held', flush=True); time.sleep(120)"
    )
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        process.stdout.readline()
        with pytest.raises(UniSGError, match="another export is writing"), folder_lock(tmp_path):
            pass
        process.kill()
    with folder_lock(tmp_path):
        pass
    assert list(tmp_path.iterdir()) == []


def test_the_file_of_a_lock_from_before_is_taken_away(tmp_path: Path) -> None:
    (tmp_path / ".lock").touch()
    with folder_lock(tmp_path):
        pass
    assert not (tmp_path / ".lock").exists()


@LINUX
def test_a_folder_that_cannot_be_held_is_held_by_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As on a network drive, whose folders cannot be locked."""
    fcntl = pytest.importorskip("fcntl")
    flock = fcntl.flock

    def like_nfs(handle: int, operation: int) -> None:
        if os.path.isdir(f"/proc/self/fd/{handle}"):
            raise OSError(9, "Bad file descriptor")
        flock(handle, operation)

    monkeypatch.setattr(fcntl, "flock", like_nfs)
    with folder_lock(tmp_path):
        assert [path.name for path in tmp_path.iterdir()] == [".lock"]
        with pytest.raises(UniSGError, match="another export is writing"), folder_lock(tmp_path):
            pass
    assert list(tmp_path.iterdir()) == []


def test_a_signal_waits_until_a_library_is_loaded() -> None:
    before, reached = signal.getsignal(signal.SIGINT), []
    with pytest.raises(KeyboardInterrupt):  # noqa: PT012 (how far it came is the question)
        with signals_kept():
            signal.raise_signal(signal.SIGINT)
            reached.append("inside")
        reached.append("after")
    assert reached == ["inside"]
    assert signal.getsignal(signal.SIGINT) is before


@LINUX
def test_blender_is_loaded_to_its_end_when_it_is_interrupted() -> None:
    """Python that is interrupted inside Blender's beginning crashes it, or is not heard."""
    code = (
        "import os, signal, sys, threading\n"
        "class Look:\n"  # asks for the end as soon as Blender's own modules are looked for, a few times
        "    left = 3\n"
        "    def find_spec(self, name, path=None, target=None):\n"
        "        if name.startswith('bpy.') and self.left:\n"
        "            self.left -= 1\n"
        "            signal.raise_signal(signal.SIGINT)\n"
        "sys.meta_path.insert(0, Look())\n"
        "try:\n"
        "    import unisg_blender.blender\n"
        "except KeyboardInterrupt:\n"
        "    import bpy\n"
        "    print('stopped', bpy.app.version > (4, 0), Look.left, flush=True)\n"
        "os._exit(0)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=SECONDS, check=False)
    assert done.stdout.split()[:2] == ["stopped", "True"], done.stderr

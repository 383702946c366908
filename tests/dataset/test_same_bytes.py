"""The same bytes from any number of jobs and kills, whatever reads the files."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytest.importorskip("bpy")

from unisg_blender.cli import main

pytestmark = [pytest.mark.slow, pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")]
LIMIT = 120


def start(folder: Path, out: str, jobs: int, *more: str) -> subprocess.Popen[bytes]:
    words = ["in", *sorted(str(path.relative_to(folder)) for path in folder.glob("in/*/*.json"))]
    command = [sys.executable, "-m", "unisg_blender", "export", *words, "--out", out, "--jobs", str(jobs), "-q", *more]
    return subprocess.Popen(command, cwd=folder)


def test_jobs_and_kills_do_not_show_in_a_dataset(tmp_path: Path) -> None:
    for seed, kind in enumerate(("json", "usda", "blend") * 2):
        words = [
            "world",
            "cubes",
            "--seed",
            str(seed),
            "--format",
            kind,
            "--out",
            str(tmp_path / "in" / str(seed)),
            "-q",
        ]
        assert main(words) == 0
    for out, jobs in (("one", 1), ("two", 2)):
        assert start(tmp_path, out, jobs).wait(LIMIT) == 0
    process = start(tmp_path, "killed", 2)
    for delay in (1.5, 2.5, 3.5):
        time.sleep(delay)
        process.send_signal(signal.SIGKILL)
        process.wait(LIMIT)
        process = start(tmp_path, "killed", 1, "--resume")
    assert process.wait(LIMIT) == 0
    one, two, killed = (
        {path.name: path.read_bytes() for path in (tmp_path / out).iterdir()} for out in ("one", "two", "killed")
    )
    assert one == two == killed

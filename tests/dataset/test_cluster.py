"""``--scheduler``: a Dask scheduler and a worker as processes of their own."""

from __future__ import annotations

import contextlib
import json
import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from unisg_blender.cli import main
from unisg_blender.dataset.export.batch_export import ExportOptions, export_dataset

pytestmark = pytest.mark.slow

pytest.importorskip("distributed")
HERE = Path(__file__).parent
READER = "fake_reader:read"
LIMIT = 60


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@contextlib.contextmanager
def dask(*words: str) -> Iterator[None]:
    """A part of a cluster; ended at the end, whatever happens."""
    environment = os.environ | {"PYTHONPATH": str(HERE), "DASK_DISTRIBUTED__WORKER__DAEMON": "False"}
    process = subprocess.Popen([sys.executable, "-m", "distributed.cli." + words[0], *words[1:]], env=environment)
    try:
        yield
    finally:
        process.terminate()
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()


def wait_for(port: int) -> None:
    deadline = time.monotonic() + LIMIT
    while time.monotonic() < deadline:
        with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), timeout=1):
            return
        time.sleep(0.1)
    raise TimeoutError("the scheduler did not come up")


def test_a_cluster_gives_the_same_dataset(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(HERE), prepend=os.pathsep)
    defaults = ExportOptions.__init__.__defaults__
    assert defaults is not None
    monkeypatch.setattr(ExportOptions.__init__, "__defaults__", (*defaults[:-1], READER))
    (tmp_path / "in").mkdir()
    for number in range(6):
        trouble = "crash" if number == 3 else ""
        (tmp_path / "in" / f"{number}.obj").write_text(json.dumps({"seed": number, "trouble": trouble}))
    port = free_port()
    address = f"tcp://127.0.0.1:{port}"
    quiet = ("--no-dashboard", "--host", "127.0.0.1")
    with dask("dask_scheduler", *quiet, "--port", str(port)):
        wait_for(port)
        with dask("dask_worker", address, *quiet, "--no-nanny", "--nthreads", "2"):
            words = ["export", str(tmp_path / "in"), "--out", str(tmp_path / "ds"), "--scheduler", address, "-q"]
            assert main(words) == 3  # one of them crashes its reader, and only that
    export_dataset([tmp_path / "in"], tmp_path / "own", ExportOptions(timeout=300.0), jobs=2)
    named = [{path.name: path.read_bytes() for path in (tmp_path / name).iterdir()} for name in ("ds", "own")]
    assert named[0] == named[1]

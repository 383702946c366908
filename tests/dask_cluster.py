"""A Dask cluster on this machine."""

from __future__ import annotations

import contextlib
import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator

LIMIT = 60


@contextlib.contextmanager
def cluster(workers: int, threads: int, **environment: str) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """The address of a scheduler on 127.0.0.1, and its workers; ended at the end, whatever happens."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    settings = os.environ | {"DASK_DISTRIBUTED__WORKER__DAEMON": "False"} | environment
    quiet = ("--no-dashboard", "--host", "127.0.0.1")
    address = f"tcp://127.0.0.1:{port}"
    started = [("dask_scheduler", *quiet, "--port", str(port))]
    started += [("dask_worker", address, *quiet, "--no-nanny", "--nthreads", str(threads))] * workers
    processes: list[subprocess.Popen[bytes]] = []
    try:
        for name, *words in started:
            command = [sys.executable, "-m", f"distributed.cli.{name}", *words]
            processes.append(subprocess.Popen(command, env=settings, stderr=subprocess.DEVNULL))
            _wait_for(port)
        yield address, processes[1:]
    finally:
        for process in processes:
            process.kill()
            process.wait(10)


def _wait_for(port: int) -> None:
    deadline = time.monotonic() + LIMIT
    while time.monotonic() < deadline:
        with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), timeout=1):
            return
        time.sleep(0.1)
    raise TimeoutError("the scheduler did not come up")

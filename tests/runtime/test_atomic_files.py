"""Files and folders are written whole or not at all; processes of a pool end with who started them."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import pytest

from unisg_blender.errors import UniSGError
from unisg_blender.runtime.atomic_files import replacing, write_file


def stop_halfway(path: Path) -> None:
    path.write_text("half")
    raise RuntimeError


def test_a_failing_writer_leaves_what_was_there(tmp_path: Path) -> None:
    path = tmp_path / "scene.usda"
    write_file(path, "before")
    with pytest.raises(RuntimeError), replacing(path) as unfinished:
        stop_halfway(unfinished)
    assert [each.name for each in tmp_path.iterdir()] == ["scene.usda"]
    assert path.read_text() == "before"
    with replacing(path) as unfinished:
        assert (unfinished.parent, unfinished.suffix) == (path.parent, ".usda")
        unfinished.write_text("after")
    assert path.read_text() == "after"


def test_places_that_cannot_be_written_are_told(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").write_text("")
    for path in (tmp_path / "folder", tmp_path / "missing" / "a", tmp_path / "file" / "a"):
        with pytest.raises(UniSGError, match="cannot write"):
            write_file(path, b"")


STARTER = """
import os, time
from unisg_blender.runtime.process_pool import THREADS, process_pool

if __name__ == "__main__":
    with process_pool(1) as pool:
        print(pool.submit(os.getpid).result(), pool.submit(os.getenv, THREADS[0]).result(), flush=True)
        pool.submit(time.sleep, 600)
        time.sleep(600)
"""


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="looks at processes in /proc")
def test_workers_have_one_thread_and_end_with_a_killed_parent(tmp_path: Path) -> None:
    (tmp_path / "starter.py").write_text(STARTER)
    root = Path(__file__).parents[2]
    code = f"import sys, runpy; sys.path.insert(0, {str(root)!r}); "
    code += f"runpy.run_path({str(tmp_path / 'starter.py')!r}, run_name='__main__')"
    parent = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    assert parent.stdout is not None
    worker, threads = parent.stdout.readline().split()
    assert threads == "1"
    parent.kill()
    parent.communicate()
    deadline = time.monotonic() + 20
    while Path("/proc", worker).exists() and "zombie" not in Path("/proc", worker, "status").read_text():
        assert time.monotonic() < deadline, "the worker goes on"
        time.sleep(0.05)

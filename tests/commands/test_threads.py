"""``--jobs N`` of benchmarks: no more than N threads of torch, OpenMP and linear algebra."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("torch")
pytest.importorskip("threadpoolctl")

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = """
import sys
from unisg_blender.cli import main
from unisg_blender.commands import benchmark

benchmark.BENCHMARKS["poses"] = ("", "tests.commands.thread_counts:write_threads")
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.slow
def test_benchmarks_keep_to_the_jobs_asked_for(tmp_path: Path) -> None:
    free = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    words = ["benchmark", "poses", "--jobs", "1", "--json", "-q", "--out", str(tmp_path / "out")]
    command = [sys.executable, "-c", PROGRAM, *words]
    done = subprocess.run(command, env=free, cwd=ROOT, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    counts = json.loads(done.stdout)
    assert len(counts) >= 2
    assert set(counts.values()) == {1}

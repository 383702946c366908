"""Scripts of packaging/player that look at pages in Chromium: `make test-web`."""

from __future__ import annotations

import os
import shutil
import subprocess

import pytest

PLAYER = os.environ.get("UNISG_PLAYER", "")

needs_browser = pytest.mark.skipif(
    not PLAYER or not shutil.which("node") or not shutil.which(os.environ.get("CHROMIUM", "chromium")),
    reason="needs node, chromium and `make test-web`",
)


def looked_at(script: str, *words: object) -> str:
    """What a script prints; the test fails where the script does."""
    line = ["node", script, *map(str, words)]
    run = subprocess.run(line, cwd=PLAYER, capture_output=True, text=True, timeout=400, check=False)
    assert run.returncode == 0, run.stderr
    return run.stdout

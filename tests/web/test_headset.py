"""An emulated headset plays a lesson to its end with its hands: `make test-web`."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from unisg_blender.web import write_site
from unisg_blender.worlds import living_room

PLAYER = os.environ.get("UNISG_PLAYER", "")


@pytest.mark.slow
@pytest.mark.skipif(
    not PLAYER or not shutil.which("node") or not shutil.which(os.environ.get("CHROMIUM", "chromium")),
    reason="needs node, chromium and `make test-web`",
)
def test_hands_grab_place_and_use(tmp_path: Path) -> None:
    write_site(living_room(0), tmp_path)
    words = ["node", "headset_test.mjs", str(tmp_path)]
    played = subprocess.run(words, cwd=PLAYER, capture_output=True, text=True, timeout=280, check=False)
    assert played.returncode == 0, played.stderr
    assert '"finished":true' in played.stdout

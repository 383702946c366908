"""Makers of rooms that do what tests need: crash, hang, fail, and say in which process they were made."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from unisg_blender.batches.made_room import MadeRoom
from unisg_blender.errors import UniSGError
from unisg_blender.worlds import cubes


def room(settings: Mapping[str, Any], task: Mapping[str, Any]) -> MadeRoom:
    """Cubes, but for the seeds that have a trouble; ``log`` is a file that gets a line for each attempt."""
    seed = task["seed"]
    with open(settings["log"], "a") as log:
        log.write(f"{seed} {os.getpid()}\n")
    trouble = settings["trouble"].get(str(seed), "")
    if trouble == "crash":
        os.kill(os.getpid(), signal.SIGSEGV)
    if trouble == "crash once" and not Path(settings["log"] + ".once").exists():
        Path(settings["log"] + ".once").touch()
        os.kill(os.getpid(), signal.SIGKILL)
    if trouble == "hang":
        time.sleep(1000)
    if trouble == "refuse":
        raise UniSGError("there is no room")
    if trouble == "bug":
        raise ValueError("two\nlines")
    return MadeRoom(cubes(seed), {"cubes": 20}, "cubes")

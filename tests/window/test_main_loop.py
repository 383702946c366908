"""What stands still while models load, things are generated, placed and exported: reported, not asserted."""

from __future__ import annotations

import datetime
import json
import os
from pathlib import Path
from typing import Any

import pytest

from tests.window.blender_window import BlenderWindow, missing_tools

pytestmark = [pytest.mark.skipif(bool(missing_tools()), reason=missing_tools()), pytest.mark.slow]

WATCH = (Path(__file__).parent / "main_loop_watch.py").read_text("utf-8")
COMMAND = "pytest tests/window/test_main_loop.py"
"""How docs/results/main_loop.json is made: it is written into the folder that window and test share."""

MODULES = "__import__('sys').modules"
SETTINGS = f"{MODULES}['bl_ext.user_default.unisg_blender.operators.making.generation_settings']"
SESSION = f"{MODULES}['bl_ext.user_default.unisg_blender.operators.placing.placing_session'].placing()"
LOADED = f"{SETTINGS}.is_loaded('living_room')"
IDLE = "not bpy.context.window.modal_operators"
LOAD = f"{SETTINGS}.forget_models(); {SETTINGS}.load_soon('living_room', lambda: None, print)"
GENERATE = "bpy.ops.unisg.generate('INVOKE_DEFAULT', True, add='Chair=2,Plant=4,Book=4', model='living_room', seed=3)"
PLACE = "bpy.ops.unisg.place('INVOKE_DEFAULT', category='Cup', model='living_room')"
EXPORT = "bpy.ops.unisg.export_dataset('INVOKE_DEFAULT', filepath={folder!r}, overwrite=True)"
DRAWING = """
import time
end = time.perf_counter() + 3
def draw():
    area.tag_redraw()
    if time.perf_counter() < end:
        return 0.05
    del bpy.app.driver_namespace["drawing"]
bpy.app.driver_namespace["drawing"] = draw
bpy.app.timers.register(draw)
"""
DRAWN = "'drawing' not in bpy.app.driver_namespace"


def watched(window: BlenderWindow, name: str, begin: str, done: str) -> dict[str, Any]:
    """What the main loop did from the beginning of some work until it is done."""
    window.run(WATCH)
    window.in_viewport(begin)
    window.wait(done)
    told: dict[str, Any] = window.run("result = bpy.app.driver_namespace.pop('main_loop_watch').end()")
    told = {"name": name, **told}
    print(f"{name}: {told}")
    return told


def test_the_main_loop_goes_round_meanwhile(window: BlenderWindow, room: int) -> None:
    window.move(500, 420)
    out = f"{window.inside}/main-loop-export"
    rows = [
        watched(window, "a room is drawn over and over, nothing of ours", DRAWING, DRAWN),
        watched(window, "a model is loaded", LOAD, LOADED),
        watched(window, "10 things are generated", GENERATE, f"len(bpy.data.objects) > {room} and {IDLE}"),
        watched(window, "a room is looked at to place a cup", PLACE, f"{SESSION} and {SESSION}.room"),
    ]
    window.key("Escape")
    rows.append(watched(window, "what is open is exported", EXPORT.format(folder=out), IDLE))
    record = {"command": COMMAND, "date": datetime.date.today().isoformat(), "load": os.getloadavg()[0]}
    for row in rows:
        row |= {"stood_ms": max(row["gaps_ms"]), "longest_ms": max(row["ours_ms"]), "work_ms": max(row["ours_work_ms"])}
    (window.folder / "main-loop.json").write_text(json.dumps({**record, "rows": rows}, indent=1), encoding="utf-8")
    for row in rows:
        assert row["rounds"] > 2, row
    assert (window.folder / "main-loop-export").is_dir()

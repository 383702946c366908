"""The panels of the building and of the check say what is known, whatever state the scene is in."""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from pathlib import Path
from types import ModuleType, SimpleNamespace
from unittest.mock import MagicMock

import pytest

bpy = pytest.importorskip("bpy")

from tests.generate.house import KITCHEN, house  # noqa: E402
from tests.spatial.built_rooms import box  # noqa: E402
from unisg_blender.blender import write_scene  # noqa: E402


def labels(extension: ModuleType, module: str, panel: str) -> str:
    """All labels of a panel, one after the other."""
    layout = MagicMock()
    for name in ("row", "column", "box", "grid_flow"):
        getattr(layout, name).return_value = layout
    context = SimpleNamespace(
        region=SimpleNamespace(width=400),
        **{name: getattr(bpy.context, name) for name in ("scene", "window_manager", "active_object")},
    )
    getattr(getattr(extension.panels, module), panel).draw(SimpleNamespace(layout=layout), context)
    return " ".join(call.kwargs.get("text", "") for call in layout.label.call_args_list)


@pytest.fixture
def recognised(extension: ModuleType) -> ModuleType:
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    write_scene(house(things=KITCHEN | {"High": box((2, 1, 0.2), (2.5, 1.5, 0.6))}), bpy.context.scene)
    bpy.context.view_layer.objects.active = bpy.data.objects["ground"]
    return sys.modules[f"{extension.__name__}.operators.room.recognised"]


def test_rooms_and_what_the_active_object_is_are_told(extension: ModuleType, recognised: ModuleType) -> None:
    def told() -> str:
        return labels(extension, "recognised_building", "UNISG_PT_building")

    assert told() == "ground is:"
    recognised.recognise_now(bpy.context.scene)
    assert "kitchen, 20.0 m2" in told()
    assert "ground: Floor, as recognised" in told()
    bpy.context.view_layer.objects.active = bpy.data.objects["High"]
    assert "High is:" in told()
    bpy.data.objects["High"].select_set(True)
    bpy.ops.unisg.mark_part(part="WALL")
    assert "High: Wall, as you say" in told()
    bpy.ops.unisg.mark_part(part="THING")
    assert "High: not building, as you say" in told()


def test_the_check_is_told(extension: ModuleType, recognised: ModuleType) -> None:
    assert labels(extension, "check", "UNISG_PT_check") == ""
    bpy.ops.unisg.check()
    assert labels(extension, "check", "UNISG_PT_check") == "4 things: 3 fine, 1 floating"
    bpy.context.window_manager.unisg_check.active = 0
    assert labels(extension, "check", "UNISG_PT_check").endswith("High floats by 20 cm")
    bpy.data.objects["High"].location.x += 0.1
    bpy.context.view_layer.update()
    assert "Changed since: check again" in labels(extension, "check", "UNISG_PT_check")
    bpy.ops.unisg.check()
    assert "Changed since" not in labels(extension, "check", "UNISG_PT_check")


def test_switching_the_overlay_in_background_is_harmless(extension: ModuleType, recognised: ModuleType) -> None:
    bpy.context.window_manager.unisg_structure_shown = True
    bpy.data.objects["High"].location.x += 1
    bpy.context.view_layer.update()
    assert not recognised.looking()
    bpy.context.window_manager.unisg_structure_shown = False


def taken(work) -> None:
    """Look as Blender's timer does, until the work is done."""
    while work._timer() is not None:
        time.sleep(0.01)


def test_background_work_is_taken_or_told(extension: ModuleType) -> None:
    module = sys.modules[f"{extension.__name__}.operators.room.background"]
    errors = sys.modules[f"{extension.__name__}.unisg_blender.errors"]
    done, failed = [], []

    def refuse() -> int:
        raise errors.UniSGError("no room")

    def break_down() -> int:
        raise ZeroDivisionError

    work = module.Background()
    for job in (lambda: 3, refuse, break_down):
        work.start(job, done.append, failed.append)
        assert work.busy
        if job is break_down:
            with pytest.raises(ZeroDivisionError):
                taken(work)
        else:
            taken(work)
        assert not work.busy
    assert done == [3]
    assert failed == ["no room", "it failed: the system console says why"]
    work.end()


def test_what_was_looked_at_is_looked_at_anew_once(extension: ModuleType) -> None:
    module = sys.modules[f"{extension.__name__}.operators.room.background"]
    errors = sys.modules[f"{extension.__name__}.unisg_blender.errors"]
    work, started, failed = module.Background(), [], []

    def refuse(scene: bpy.types.Scene) -> None:
        raise errors.UniSGError("no room")

    def tell(scene: str, text: str) -> None:
        failed.append((scene, text))

    other = bpy.data.scenes.new("Other")  # of another window; a timer does not know which one a user is in
    work.start_soon("Other", lambda scene: started.append(scene.name), tell)
    begin = work._soon
    work.start_soon("Other", refuse, tell)
    assert work._soon is begin, "it is to come already"
    assert begin() is None
    assert started == ["Other"]
    work.start_soon("Other", refuse, tell)
    work.start(lambda: (), list, list)
    assert work._soon() == module.SOON, "it waits for what goes on"
    taken(work)
    work._soon()
    assert failed == [("Other", "no room")]
    bpy.data.scenes.remove(other)
    work.start_soon("Other", refuse, tell)
    begin = work._soon
    begin()
    assert failed[1:] == [("", "")], "there is nothing to say of a scene that is gone"
    work.start_soon("Other", refuse, tell)
    begin = work._soon
    work.end()
    assert not bpy.app.timers.is_registered(begin)


def test_the_end_of_the_extension_does_not_wait_for_work(extension: ModuleType) -> None:
    """What comes of it later is dropped, and the next work is not taken for it."""
    module = sys.modules[f"{extension.__name__}.operators.room.background"]
    goes_on, done = threading.Event(), []
    work = module.Background()
    work.start(lambda: goes_on.wait(60), done.append, done.append)
    (thread,) = [each for each in threading.enumerate() if each.name == "UniSG"]
    timer = work._timer
    work.end()
    assert thread.is_alive()
    assert not work.busy
    assert not bpy.app.timers.is_registered(timer)
    goes_on.set()
    thread.join()
    assert done == []


@pytest.mark.parametrize("name", ["checking", "recognised"])
def test_another_file_lets_work_go(extension: ModuleType, name: str) -> None:
    """Blender forgets its timers then: nobody would take what comes of it, and the button would stay grey."""
    work = sys.modules[f"{extension.__name__}.operators.room.{name}"]._background
    work.start(lambda: 1, list, list)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert not work.busy


def test_switching_off_loads_nothing() -> None:
    """What was never used is not loaded to be stopped: it takes a third of a second."""
    code = (
        "import sys, bpy\n"
        "from tests.extension_package import load_extension\n"
        "package = load_extension(); package.register(); before = set(sys.modules); package.unregister()\n"
        "print(sorted(name for name in set(sys.modules) - before if name.startswith(package.__name__)))\n"
    )
    root = Path(__file__).resolve().parents[2]
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=True, timeout=120
    )
    assert done.stdout.strip().splitlines()[-1] == "[]"

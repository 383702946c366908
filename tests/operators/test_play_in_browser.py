"""The scene is shown at an address of this machine until that is ended, or the extension is."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from urllib.error import URLError
from urllib.request import urlopen

import bpy
import pytest

from tests.extension_package import NAME
from unisg_blender.blender import write_scene
from unisg_blender.worlds import living_room

pytestmark = pytest.mark.usefixtures("extension", "fresh_file")


def test_it_is_served_changed_and_ended() -> None:
    module = import_module(f"{NAME}.operators.interchange.play_in_browser")
    with pytest.raises(RuntimeError, match="is empty"):
        bpy.ops.unisg.play_in_browser()
    bpy.context.window.scene = write_scene(living_room(1))
    assert bpy.ops.unisg.play_in_browser() == {"FINISHED"}
    address = module.served_address()
    assert address.startswith("http://127.0.0.1:")
    page = urlopen(address, timeout=10).read().decode()
    assert "Cushion" in page
    assert urlopen(f"{address}room.glb", timeout=10).read()[:4] == b"glTF"
    folder = Path(module._served[0][1].name)
    bpy.data.objects["Cushion"].name = "Renamed"
    assert bpy.ops.unisg.play_in_browser() == {"FINISHED"}
    assert module.served_address() == address
    assert "Renamed" in urlopen(address, timeout=10).read().decode()
    assert bpy.ops.unisg.browser_stop() == {"FINISHED"}
    with pytest.raises(URLError):
        urlopen(address, timeout=10)
    assert not folder.exists()
    assert module.served_address() == ""


def test_a_lesson_that_is_not_sound_is_told_and_nothing_is_shown() -> None:
    module = import_module(f"{NAME}.operators.interchange.play_in_browser")
    bpy.context.window.scene = write_scene(living_room(1))
    target = next(item for item in bpy.data.objects if "unisg_actions" in item)
    target["unisg_actions"] = "[]"
    with pytest.raises(RuntimeError):
        bpy.ops.unisg.play_in_browser()
    assert module.served_address() == ""

"""A furnished room, for tests that say by ``SEED`` which."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import pytest


@pytest.fixture(scope="module")
def saved(extension: ModuleType, request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A living room in a file."""
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.unisg.add_room(kind="living-room", seed=request.module.SEED)
    path = tmp_path_factory.mktemp("room") / "room.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


@pytest.fixture
def room(saved: Path) -> None:
    """The room is open, and nothing selected."""
    import bpy

    bpy.ops.wm.open_mainfile(filepath=str(saved))
    bpy.ops.object.select_all(action="DESELECT")

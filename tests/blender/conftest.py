"""Every test starts from an empty Blender file."""

from __future__ import annotations

import importlib.util

import pytest

if importlib.util.find_spec("bpy") is None:
    collect_ignore_glob = ["*"]


@pytest.fixture(autouse=True)
def fresh_file() -> None:
    """An empty file without objects, whatever the test before left behind."""
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)

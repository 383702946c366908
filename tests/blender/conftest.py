"""Every test starts from an empty Blender file."""

from __future__ import annotations

import importlib.util

import pytest

if importlib.util.find_spec("bpy") is None:
    collect_ignore_glob = ["*"]


@pytest.fixture(autouse=True)
def empty_file(fresh_file: None) -> None:
    """Every test of this room."""

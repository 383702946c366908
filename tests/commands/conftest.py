"""Running verbs in this process; Blender comes first, for it brings its own USD."""

from __future__ import annotations

import contextlib
from collections.abc import Callable

import pytest

with contextlib.suppress(ImportError):
    import bpy  # noqa: F401

from unisg_blender.cli import main

Run = Callable[..., tuple[str, str]]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    """Run a verb that ends with a status; what it printed to stdout and stderr."""

    def run(*words: object, status: int = 0) -> tuple[str, str]:
        assert main([str(word) for word in words]) == status
        return capsys.readouterr()

    return run

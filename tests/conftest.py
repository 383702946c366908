"""What all tests share: where real scenes are, and how many of them a run used."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

from tests.extension_package import load_extension

with contextlib.suppress(ImportError):
    import hypothesis

    hypothesis.settings.register_profile("all", deadline=None)  # a busy machine is no fault
    hypothesis.settings.register_profile("fast", deadline=None, max_examples=25)

STATUS = pytest.StashKey[int]()
SCENE_ENDINGS = (".blend", ".glb", ".gltf", ".fbx", ".obj", ".usd", ".usda", ".usdc", ".usdz")


def scene_files() -> list[Path]:
    """Files of the folder that UNISG_SCENES names; an empty list without it."""
    folder = os.environ.get("UNISG_SCENES")
    return sorted(path for path in Path(folder).rglob("*") if path.suffix in SCENE_ENDINGS) if folder else []


@pytest.fixture(scope="module")
def extension() -> Iterator[ModuleType]:
    """The whole extension, registered as Blender does."""
    package = load_extension()
    package.register()
    yield package
    package.unregister()


@pytest.fixture
def fresh_file() -> None:
    """An empty Blender file without objects, whatever the test before left behind."""
    import bpy

    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)


def pytest_configure(config: pytest.Config) -> None:
    """Properties are tried on fewer examples where slow tests are left out, unless they say on how many."""
    with contextlib.suppress(NameError):  # an environment without hypothesis
        hypothesis.settings.load_profile("fast" if config.getoption("markexpr") == "not slow" else "all")


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say how many real scenes this run used; a header would not show in a quiet run."""
    terminalreporter.write_line(f"real scenes: {len(scene_files())} (UNISG_SCENES names a folder of scenes to use)")


def pytest_sessionfinish(session: pytest.Session, exitstatus: int) -> None:
    """Keep the status for leaving."""
    session.config.stash[STATUS] = int(exitstatus)


@pytest.hookimpl(trylast=True)
def pytest_unconfigure(config: pytest.Config) -> None:
    """Leave without bpy's own cleaning up: after an undo, 4.5 waits there for a thread of its own for ever."""
    if "bpy" in sys.modules and STATUS in config.stash:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(config.stash[STATUS])

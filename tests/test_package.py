"""The package as a whole: what importing it costs, and how the command line answers."""

from __future__ import annotations

import subprocess
import sys

import pytest

from unisg_blender import cli
from unisg_blender.errors import MISUSE

HEAVY = ("bpy", "torch", "torch_geometric", "clifford", "onnxruntime", "pytorch_lightning", "scipy", "trimesh")


def run_python(source: str) -> str:
    """What a fresh Python prints."""
    return subprocess.run(
        [sys.executable, "-c", source], capture_output=True, text=True, check=True, timeout=60
    ).stdout.strip()


@pytest.mark.parametrize("module", ["unisg_blender", "unisg_blender.cli", "unisg_blender.scene"])
def test_import_loads_nothing_heavy(module: str) -> None:
    found = run_python(f"import sys, {module}; print([name for name in {HEAVY!r} if name in sys.modules])")
    assert found == "[]"


@pytest.mark.parametrize("words", [[], ["bogus"], ["inspect"], ["inspect", "--bogus", "x"], ["--bogus"]])
def test_misuse_exits_with_2_and_says_so(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(words) == MISUSE
    assert "usage:" in capsys.readouterr().err


@pytest.mark.parametrize("verb", cli.VERBS)
def test_every_verb_has_help(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main([verb, "--help"]) == 0
    shown = capsys.readouterr().out
    assert f"usage: unisg {verb}" in shown
    assert "--json" in shown


def test_three_doors_are_one(capfd: pytest.CaptureFixture[str]) -> None:
    cli.main(["--help"])
    direct = capfd.readouterr().out
    module = subprocess.run(
        [sys.executable, "-m", "unisg_blender", "--help"], capture_output=True, text=True, timeout=60
    ).stdout
    assert module == direct

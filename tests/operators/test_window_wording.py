"""What is told in a window is about fields and panels: it has no command line."""

from __future__ import annotations

import re
from pathlib import Path
from types import ModuleType

import pytest

pytest.importorskip("bpy")

ROOT = Path(__file__).resolve().parents[2]
LITERAL = re.compile(r'"([^"\n]*--[a-z][^"\n]*)"')


def messages() -> list[str]:
    """Texts of the library, beside its command line, that name an option."""
    rooms = ("formats", "generate", "predict", "meshes", "words", "dataset", "blender", "usd")
    files = [file for room in rooms for file in (ROOT / "unisg_blender" / room).rglob("*.py")]
    return [text for file in files for text in LITERAL.findall(file.read_text())]


def test_no_option_of_the_command_line_is_named(extension: ModuleType) -> None:
    told = [extension.operators.window_wording.in_window(text) for text in messages()]
    assert len(told) > 5
    assert not [text for text in told if re.search(r"--[a-z]", text)]


def test_the_fields_are_named(extension: ModuleType) -> None:
    in_window = extension.operators.window_wording.in_window
    assert in_window("put sizes.json beside it, or into --assets FOLDER") == (
        'put sizes.json beside it, or into the field "Meshes" of the import'
    )
    assert in_window("this is 'a', the first (--scene)") == "this is 'a', the first (the field \"Scene\" of the import)"
    assert in_window("say what to add (--add), or take another model") == "say what to add, or take another model"
    assert in_window("Sofa collides - by 3 cm") == "Sofa collides - by 3 cm"


def test_what_a_button_says_is_told_as_such(extension: ModuleType) -> None:
    said = extension.operators.window_wording.in_window("'Op' is linked; or generate without behaviour")
    assert said == "'Op' is linked; or untick \"With actions\""

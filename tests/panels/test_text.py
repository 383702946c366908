"""Long texts in a sidebar: in lines that fit it, whatever the resolution of the screen."""

from __future__ import annotations

from types import ModuleType, SimpleNamespace
from unittest.mock import MagicMock

import pytest

bpy = pytest.importorskip("bpy")


def lines(extension: ModuleType, text: str, width: int) -> list[tuple[str, str]]:
    """What is drawn of a text: lines with their icons."""
    layout = MagicMock()
    extension.panels.main.draw_text(layout, text, width, "PLAY")
    return [(call.kwargs["text"], call.kwargs["icon"]) for call in layout.column().label.call_args_list]


@pytest.mark.parametrize("scale", [1.0, 2.0])
def test_lines_fit_the_sidebar(extension: ModuleType, monkeypatch: pytest.MonkeyPatch, scale: float) -> None:
    preferences = SimpleNamespace(system=SimpleNamespace(ui_scale=scale))
    monkeypatch.setattr(extension.panels.main.bpy, "context", SimpleNamespace(preferences=preferences))
    text = "Put the remote before the television, where everybody who sits on the sofa can reach it"
    found = lines(extension, text, int(240 * scale))
    assert " ".join(line for line, _ in found) == text
    assert max(len(line) for line, _ in found) <= 30
    assert [icon for _, icon in found] == ["PLAY", *["BLANK1"] * (len(found) - 1)]

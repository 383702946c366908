"""Draw handlers of the 3D viewports, and words in them that are legible on any ground."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import bpy

TEXT, MARGIN = 13, 22
"""Size of the words, and how high a legend is over the lower edge, pixels at a scale of 1."""


class DrawHandlers:
    """Functions that are called whenever a viewport is drawn: ``view`` in the scene, ``words`` over it."""

    def __init__(self, view: Callable[[], None], words: Callable[[], None] | None = None) -> None:
        self._draws = [(view, "POST_VIEW"), *([(words, "POST_PIXEL")] if words is not None else [])]
        self._handles: list[Any] = []

    def start(self) -> None:
        """From now on they are called, where there is a window."""
        if not bpy.app.background:
            for draw, when in self._draws:
                self._handles.append(bpy.types.SpaceView3D.draw_handler_add(draw, (), "WINDOW", when))

    def stop(self) -> None:
        """From now on they are not."""
        while self._handles:
            bpy.types.SpaceView3D.draw_handler_remove(self._handles.pop(), "WINDOW")


@contextmanager
def shadowed_text(context: bpy.types.Context) -> Iterator[float]:
    """Words of blf are white with a shadow within; gives the scale of the interface."""
    import blf

    scale = context.preferences.system.ui_scale
    blf.size(0, TEXT * scale)
    blf.color(0, 1.0, 1.0, 1.0, 1.0)
    blf.enable(0, blf.SHADOW)
    blf.shadow(0, 3, 0.0, 0.0, 0.0, 1.0)
    try:
        yield scale
    finally:
        blf.disable(0, blf.SHADOW)

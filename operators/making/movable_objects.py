"""Which objects may be moved: those of this file, overrides of linked ones among them."""

from __future__ import annotations

from collections.abc import Iterable

import bpy

LINKED = "They are linked from another file: make a library override first (Object > Relations)"


def movable(items: Iterable[bpy.types.Object]) -> list[bpy.types.Object]:
    """Those that are of this file: what is linked moves until the file is opened again only."""
    return [item for item in items if item.library is None]

"""Names that are no Unicode, as Blender before 2.5 wrote them: Python cannot read them as they are."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import Any

import bpy

NAMED = {
    "objects": ("modifiers", "constraints", "vertex_groups"),
    "meshes": ("attributes", "uv_layers"),
    "shape_keys": ("key_blocks",),
    "armatures": ("bones",),
}
"""What of Blender's data has names within it."""


def make_names_readable() -> None:
    """Give whatever has a name that is no UTF-8 the one that it is in Latin-1."""
    for item in _named_items():
        try:
            _ = item.name
        except UnicodeDecodeError as error:
            with contextlib.suppress(AttributeError):  # of a linked file, which is not ours to change
                item.name = error.object.decode("latin-1")


def _named_items() -> Iterator[Any]:
    for prop in bpy.types.BlendData.bl_rna.properties:
        if prop.type == "COLLECTION":
            for item in list(getattr(bpy.data, prop.identifier)):
                yield item
                for part in NAMED.get(prop.identifier, ()):
                    yield from list(getattr(item, part))

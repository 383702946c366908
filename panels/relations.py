"""Sub-panel "Relations": what stands on, in or beside what, and what kind of scene it is."""

from __future__ import annotations

import json

import bpy

from ..operators.classify import KINDS_OF
from ..operators.relations import SHIPPED
from ..operators.scene_lookup import looked_up
from .main import DataPanel

SHOWN = 12
DIRECTIONS = ("above", "below", "beside", "left_of", "right_of", "in_front_of", "behind")


class UNISG_PT_relations(DataPanel):
    """What the active object stands on, in or beside"""

    bl_label = "Relations"

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column(align=True)
        column.operator("unisg.relations", icon="LINKED").model = ""
        column.operator("unisg.relations", text="Predict What Is on What", icon="EXPERIMENTAL").model = SHIPPED
        column.operator("unisg.classify", icon="SCENE_DATA")
        for line in KINDS_OF.get(context.scene.name, []):
            column.label(text=line)
        lines = _lines(context)
        column = self.layout.column(align=True)
        for line in lines[:SHOWN]:
            column.label(text=line)
        if len(lines) > SHOWN:
            column.label(text=f"... and {len(lines) - SHOWN} more")


def _lines(context: bpy.types.Context) -> list[str]:
    """The active object's relations in words."""
    item = context.active_object
    try:
        found = (
            json.loads(item["unisg_relations"])["relations"] if item is not None and "unisg_relations" in item else []
        )
        names = looked_up(context.scene).names if found else {}
        return [
            f"{pair['kind'].replace('_', ' ')} {names.get(pair['target'], '...')}" for pair in sorted(found, key=_vague)
        ]
    except (ValueError, KeyError, TypeError, AttributeError):
        return ["its relations cannot be read"]


def _vague(pair: dict[str, str]) -> bool:
    """Whether it only tells a direction: what carries and what holds an object is shown first."""
    return pair["kind"] in DIRECTIONS


CLASSES = (UNISG_PT_relations,)

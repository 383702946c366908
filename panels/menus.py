"""Menu entries where people look: Add, Object, the context menu, File > Import and Export; F3 finds them there."""

from __future__ import annotations

from collections.abc import Callable

import bpy

from ..operators.making.add_room import ROOMS


class UNISG_MT_add(bpy.types.Menu):
    """Add > UniSG"""

    bl_idname = "UNISG_MT_add"
    bl_label = "UniSG"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.operator_context = "INVOKE_DEFAULT"  # Blender's own menu Add asks for no settings
        for key, label, _ in ROOMS:
            layout.operator("unisg.add_room", text=label, icon="HOME").kind = key
        layout.separator()
        layout.operator("unisg.choose_and_place", text="Place...", icon="CURSOR")
        layout.operator("unisg.generate", text="Generate Chosen Objects", icon="ADD")
        layout.operator("unisg.make_variations_dialog", icon="DUPLICATE")


class UNISG_MT_object(bpy.types.Menu):
    """Object > UniSG, and in its context menu"""

    bl_idname = "UNISG_MT_object"
    bl_label = "UniSG"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.operator_context = "INVOKE_DEFAULT"
        layout.operator("unisg.assign_category", icon="BOOKMARKS")
        layout.operator("unisg.settle", icon="TRIA_DOWN_BAR")
        layout.operator("unisg.reroll", icon="FILE_REFRESH")
        layout.operator("unisg.lock", icon="LOCKED")
        layout.operator("unisg.check", icon="VIEWZOOM")
        layout.operator("unisg.make_variations_dialog", icon="DUPLICATE")
        layout.separator()
        layout.operator_menu_enum("unisg.mark_part", "part", text="This Is", icon="HOME")
        layout.operator("unisg.mark_room", text="Its Room Is...").number = -1
        layout.separator()
        layout.operator("unisg.repair_identities", icon="FILE_REFRESH")


def _add(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.menu("UNISG_MT_add", icon="HOME")


def _object(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.separator()
    menu.layout.menu("UNISG_MT_object")


def _import(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.operator("unisg.open_master_file", text="UniSG Master File (.usd*, .json)")


def _export(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.operator("unisg.convert", text="UniSG Master File (.usd*, .json)")


def _render(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.separator()
    menu.layout.operator("unisg.render_labels_dialog", icon="RENDER_STILL")


PLACES: tuple[tuple[str, Callable[[bpy.types.Menu, bpy.types.Context], None]], ...] = (
    ("VIEW3D_MT_add", _add), ("VIEW3D_MT_object", _object), ("VIEW3D_MT_object_context_menu", _object),
    ("TOPBAR_MT_file_import", _import), ("TOPBAR_MT_file_export", _export),
    ("TOPBAR_MT_render", _render),
)  # fmt: skip
"""Blender's menus that get an entry."""

CLASSES = (UNISG_MT_add, UNISG_MT_object)


def register() -> None:
    """Add the entries."""
    for menu, draw in PLACES:
        getattr(bpy.types, menu).append(draw)


def unregister() -> None:
    """Take them out again."""
    for menu, draw in PLACES:
        getattr(bpy.types, menu).remove(draw)

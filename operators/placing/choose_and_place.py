"""Choose what to place from a list that is searched by typing."""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from ...unisg_blender.errors import UniSGError
from ..base import SearchOperator
from ..making.generation_settings import chosen_model, is_loaded, load_generator, load_soon
from ..shapes.library_index import LibraryAsset, known_assets
from ..shapes.shape_sources import file_assets

OWN, ASSET = "OBJECT:", "ASSET:"
_items: list[tuple[str, str, str]] = []


def _choices(operator: object, context: bpy.types.Context | None) -> list[tuple[str, str, str]]:
    """The active object, what is marked as an asset here and in libraries, and what the chosen model knows."""
    found = []
    if context is not None:
        active = context.active_object
        if active is not None and active.type in ("MESH", "EMPTY"):
            found.append((f"{OWN}{active.name}", f"Another {active.name}", "The active object once more"))
        for number, asset in enumerate(_assets()):
            text = f"{asset.shape.name} ({asset.library or 'This File'})"
            found.append((f"{ASSET}{number}", text, "This very asset: an instance of it, or a linked duplicate"))
        names = load_generator(chosen_model(context)).categories
        found += [(name, name, f"{name}, as the model knows it") for name in names]
    _items[:] = found  # Blender keeps no reference to the strings of a computed enum: we must
    return _items


class UNISG_OT_choose_and_place(SearchOperator):
    """Choose what to place by pointing: what the model knows, the active object once more, or a collection asset"""

    bl_idname = "unisg.choose_and_place"
    bl_label = "Place..."
    bl_options = {"INTERNAL"}
    bl_property = "thing"

    thing: bpy.props.EnumProperty(name="Thing", items=_choices, options={"SKIP_SAVE"})

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return "" if context.mode == "OBJECT" else "Leave edit mode first"

    def run(self, context: bpy.types.Context) -> None:
        if self.thing.startswith(OWN):
            bpy.ops.unisg.place("INVOKE_DEFAULT", source=self.thing.removeprefix(OWN))
        elif self.thing.startswith(ASSET):
            asset = _assets()[int(self.thing.removeprefix(ASSET))]
            category = _category(asset, chosen_model(context))
            bpy.ops.unisg.place("INVOKE_DEFAULT", asset=asset.shape.text, category=category)
        else:
            bpy.ops.unisg.place("INVOKE_DEFAULT", category=self.thing)


def _assets() -> list[LibraryAsset]:
    return [*file_assets(), *known_assets()]


def _category(asset: LibraryAsset, model: str) -> str:
    """What an asset is by the first of its words that the model, or the table of words, knows; "" for none."""
    generator = load_generator(model)
    for word in asset.words:
        try:
            return next(iter(generator.understood({word: 1})))
        except UniSGError:
            continue  # no word for a thing
    return ""


def ask_what(context: bpy.types.Context) -> set[str]:
    """Ask what is to be placed, as soon as the model is loaded."""
    model = chosen_model(context)
    if is_loaded(model):
        bpy.ops.unisg.choose_and_place("INVOKE_DEFAULT")
        return {"CANCELLED"}
    x, y = context.area.x, context.area.y

    def ask() -> None:
        """Ask in the viewport in which it was asked for."""
        for place in _viewports(x, y):
            with bpy.context.temp_override(**place):
                bpy.ops.unisg.choose_and_place("INVOKE_DEFAULT")

    def tell(text: str) -> None:
        """Say there why there is nothing to choose."""
        for place in _viewports(x, y):
            with bpy.context.temp_override(**place):
                bpy.context.window_manager.popup_menu(lambda menu, _: menu.layout.label(text=text), title="UniSG")

    context.workspace.status_text_set("Loading the model ...")
    load_soon(model, ask, tell)
    return {"CANCELLED"}


def _viewports(x: int, y: int) -> Iterator[dict[str, object]]:
    """The viewport at a place of a window, looked up anew: a timer knows none, and meanwhile it may have gone."""
    for window in bpy.context.window_manager.windows:
        window.workspace.status_text_set(None)
        for area in window.screen.areas:
            if (area.x, area.y, area.type) == (x, y, "VIEW_3D"):
                region = next(item for item in area.regions if item.type == "WINDOW")
                yield {"window": window, "area": area, "region": region}
                return


CLASSES = (UNISG_OT_choose_and_place,)

"""What a user sets once for all files, in Blender's preferences."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import bpy

NAME = (__package__ or "").rpartition(".")[0]
"""The extension's package, under which Blender keeps its preferences."""

HOMES = (
    ("ROOM", "With the Room", "In the collection of what holds them, or of most of the scene's things"),
    ("ACTIVE", "Active Collection", "In the collection that is active in the outliner"),
    ("OWN", "Their Own", "In a collection of the scene that is called UniSG"),
)
USES = (
    ("LINK", "Link", "Their data stays in the library's file, and changes with it"),
    ("APPEND", "Append", "Their data is copied into this file"),
)
COLOURS = {
    "fits": (0.4, 0.8, 1.0), "wrong": (1.0, 0.6, 0.2), "cold": (0.15, 0.25, 0.75), "warm": (0.85, 0.25, 0.45),
    "hot": (1.0, 0.9, 0.25),
}  # fmt: skip
"""What is drawn while placing: the ghost where it fits and where not, and the heat from unlikely to likely."""

DEFAULTS: dict[str, object] = {"models": "", "first": "", "threads": 1, "home": "ROOM", "use": "LINK", **COLOURS}


def _colour(name: str, text: str) -> bpy.types.Property:
    return bpy.props.FloatVectorProperty(name=text, subtype="COLOR", size=3, min=0, max=1, default=COLOURS[name])


when_models_change: list[Callable[[], None]] = []
"""What is to be done when another folder, or number of threads, is set."""


def _models_changed(settings: UNISG_Preferences, context: bpy.types.Context) -> None:
    for act in when_models_change:
        act()


class UNISG_Preferences(bpy.types.AddonPreferences):
    """Models, where new objects go, and the colours of what is drawn."""

    bl_idname = NAME

    models: bpy.props.StringProperty(
        name="Model Folder", description="A folder with models of your own: all of it are in the list of models",
        subtype="DIR_PATH", update=_models_changed,
    )  # fmt: skip
    first: bpy.props.StringProperty(
        name="First Model", description="Name of the model that is chosen at first, such as living_room"
    )
    threads: bpy.props.IntProperty(
        name="Threads", description="How many a model may use when it is asked", default=1, min=1,
        max=max(os.cpu_count() or 1, 1), update=_models_changed,
    )  # fmt: skip
    home: bpy.props.EnumProperty(name="New Objects", description="To which collection they go", items=HOMES)
    use: bpy.props.EnumProperty(
        name="Assets of Libraries", description="How shapes are taken from asset libraries", items=USES
    )
    fits: _colour("fits", "Ghost, Fits")
    wrong: _colour("wrong", "Ghost, Wrong")
    cold: _colour("cold", "Unlikely")
    warm: _colour("warm", "Between")
    hot: _colour("hot", "Likely")

    def draw(self, context: bpy.types.Context) -> None:
        """All of it."""
        layout = self.layout
        layout.use_property_split = True
        for name in ("models", "first", "threads", "home", "use"):
            layout.prop(self, name)
        layout.operator("unisg.look_through_libraries", icon="ASSET_MANAGER")
        column = layout.column(heading="Colours of Placing")
        for name in COLOURS:
            column.prop(self, name)


def preference(name: str) -> object:
    """What a user set; what is usual where the extension is not in Blender's list, as in scripts."""
    addon = bpy.context.preferences.addons.get(NAME)
    found = getattr(addon.preferences, name, None) if addon is not None else None
    return DEFAULTS[name] if found is None else found


def own_models() -> list[Path]:
    """The models in the folder of the preferences, by name."""
    folder = str(preference("models"))
    return sorted(Path(bpy.path.abspath(folder)).glob("*.onnx")) if folder else []


CLASSES = (UNISG_Preferences,)

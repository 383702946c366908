"""Suggest what is missing here by the model, and how likely that is; a click places it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import bpy
from bpy.app.handlers import persistent

from ..base import Operator, redraw_views
from ..room.background import Background
from .generation_settings import opened_generator, read_words, scene_in_words

if TYPE_CHECKING:
    from ...unisg_blender.generate.observe.missing_things import Suggestion

MOST = 8
"""How many things are suggested."""

_background: Background[tuple[Suggestion, ...]] = Background()


class UNISG_Suggestion(bpy.types.PropertyGroup):
    """Something that is missing: ``name`` is its category."""

    share: bpy.props.FloatProperty(subtype="FACTOR", min=0, max=1)
    count: bpy.props.IntProperty()


class UNISG_Suggestions(bpy.types.PropertyGroup):
    """What was suggested for a scene of so many ``objects`` by a model; ``text`` says what else is to be said."""

    scene: bpy.props.StringProperty()
    model: bpy.props.StringProperty()
    objects: bpy.props.IntProperty()
    text: bpy.props.StringProperty()
    things: bpy.props.CollectionProperty(type=UNISG_Suggestion)


class UNISG_OT_suggest(Operator):
    """Tell what is missing here: what the rooms like it, of those that the model learned from, have more of"""

    bl_idname = "unisg.suggest"
    bl_label = "What Is Missing?"
    bl_options = {"REGISTER"}

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return "This is being looked at" if _background.busy else ""

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        return self.reporting(_start, context.scene)

    def run(self, context: bpy.types.Context) -> None:
        model = _model()
        _list(context.scene.name, model, _work(context.scene, model)())
        self.report({"INFO"}, context.window_manager.unisg_suggested.text or "See the panel Suggest")


def suggesting() -> bool:
    """Whether it is being looked what is missing."""
    return _background.busy


def suggest_again() -> None:
    """Look at what was suggested anew, when Blender has finished what it does; without a window it is emptied."""
    listed = bpy.context.window_manager.unisg_suggested
    if not listed.scene:
        return
    if bpy.app.background:
        _say("", "", "")
    else:
        _background.start_soon(listed.scene, _start, lambda scene, text: _say(scene, _model(), text))


def _model() -> str:
    """The model that is chosen in the panel."""
    return str(bpy.context.window_manager.unisg.model_file())


def _start(scene: bpy.types.Scene) -> set[str]:
    name, model = scene.name, _model()
    work = _work(scene, model)
    _background.start(
        work, lambda found: _list(name, model, found), lambda text: _say(name, model, text)
    )  # fmt: skip
    return {"FINISHED"}


def _work(scene: bpy.types.Scene, model: str) -> Callable[[], tuple[Suggestion, ...]]:
    """What is to be done in the background: Blender's data is read here."""
    from ...unisg_blender.generate.observe.missing_things import suggestions

    mapping = read_words(bpy.context.window_manager.unisg.words)
    graph, path = scene_in_words(scene, mapping), bpy.path.abspath(model)

    def work() -> tuple[Suggestion, ...]:
        """Load the model, if need be, and ask it."""
        generator = opened_generator(path)
        return suggestions(generator.read(graph, mapping.get("words", {})), generator.contract)

    return work


def _say(scene: str, model: str, text: str) -> None:
    listed = bpy.context.window_manager.unisg_suggested
    listed.things.clear()
    listed.scene, listed.model, listed.text = scene, model, text
    listed.objects = len(bpy.data.scenes[scene].objects) if scene in bpy.data.scenes else 0


def _list(scene: str, model: str, found: tuple[Suggestion, ...]) -> None:
    _say(scene, model, "" if found else "Nothing is missing that rooms like this one have")
    for each in found[:MOST]:
        item = bpy.context.window_manager.unisg_suggested.things.add()
        item.name, item.share, item.count = each.category, each.share, each.count
    redraw_views(bpy.context)


@persistent
def _undone(*_: object) -> None:
    suggest_again()


@persistent
def _loaded(*_: object) -> None:
    _background.end()
    _say("", "", "")


CLASSES = (UNISG_Suggestion, UNISG_Suggestions, UNISG_OT_suggest)
HANDLERS = (("undo_post", _undone), ("redo_post", _undone), ("load_post", _loaded))
PROPERTIES = ((bpy.types.WindowManager, "unisg_suggested", bpy.props.PointerProperty(type=UNISG_Suggestions)),)


def unregister() -> None:
    """Let go what is being looked at."""
    _background.end()

"""Add new, categorised objects to the scene with a trained model."""

from __future__ import annotations

import random
import time
from typing import TYPE_CHECKING, Any

import bpy

from ...unisg_blender.errors import UniSGError
from ..base import SteppedOperator, Steps
from ..scene_lookup import looked_up
from ..shapes.given_shapes import given_shapes
from ..threaded_steps import Share, in_thread
from .generation_settings import (
    GenerationChoices,
    load_generator,
    opened_generator,
    read_words,
    scene_in_words,
    shipped_models,
)
from .new_objects import bring_in, select_new

if TYPE_CHECKING:
    from ...unisg_blender.dataset.assets.asset import Asset
    from ...unisg_blender.generate import Generated
    from ...unisg_blender.scene import SceneGraph


class UNISG_OT_generate(GenerationChoices, SteppedOperator):
    """Add objects where the model thinks they belong; nothing that is there already is moved"""

    bl_idname = "unisg.generate"
    bl_label = "Generate"
    bl_options = {"REGISTER", "UNDO"}

    model: bpy.props.StringProperty(
        name="Model", description="ONNX file or name of a shipped model; that of operating rooms when empty",
        options={"SKIP_SAVE"},
    )  # fmt: skip
    add: bpy.props.StringProperty(
        name="Add", description='Categories and numbers, such as "Scalpel=2,Monitor=1"', options={"SKIP_SAVE"}
    )
    on: bpy.props.StringProperty(
        name="On", description="Name of an object on which all are wanted; empty: anywhere", options={"SKIP_SAVE"}
    )
    beside: bpy.props.StringProperty(
        name="Beside", description="Name of an object beside which all are wanted; empty: anywhere",
        options={"SKIP_SAVE"},
    )  # fmt: skip
    within: bpy.props.StringProperty(
        name="In", description='The room in which all are wanted: "kitchen", or its number; empty: anywhere',
        options={"SKIP_SAVE"},
    )  # fmt: skip

    @classmethod
    def description(cls, context: bpy.types.Context, properties: UNISG_OT_generate) -> str:
        """The tooltip: it says where they go."""
        places = [
            f"{word} {name}"
            for word, name in (("on", properties.on), ("beside", properties.beside), ("in room", properties.within))
            if name
        ]
        where = " and ".join(places) or "where the model thinks they belong"
        return f"Add objects {where}; nothing that is there already is moved"

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return "" if context.mode == "OBJECT" else "Leave edit mode first"

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if not self.add:  # from a menu: what is chosen in the panel
            settings = context.window_manager.unisg
            if lacks := settings.lacks(context.active_object):
                self.report({"ERROR"}, f"{lacks} in the sidebar (N), tab UniSG, Generate")
                return {"CANCELLED"}
            settings.hand_over(self, context.active_object)
        return super().invoke(context, event)

    def steps(self, context: bpy.types.Context) -> Steps:
        """Read the scene and place one object after another; Blender's data is not touched before the end."""
        from ...unisg_blender.generate.counts import parse_counts

        shipped = shipped_models()
        if not self.model and not shipped:
            raise UniSGError("no model came with this installation: give one from 'unisg train cgvae'")
        model = bpy.path.abspath(self.model or str(shipped[0]))
        if self.seed < 0:
            self.seed = random.randrange(2**31)
        mapping = read_words(self.words)
        counts = parse_counts(self.add)
        self._began = time.perf_counter()
        shapes = yield from given_shapes(context.scene, counts, self.seed)
        graph, asked = scene_in_words(context.scene, mapping), {"bulk": self.bulk, "behaviour": self.behaviour}
        asked |= {"on": self.on, "beside": self.beside, "within": self.within, "words": mapping.get("words", {})}
        asked["sampling"] = self.sampling()
        seed = self.seed
        self._result = yield from in_thread(
            lambda share: _generated(model, graph, counts, seed, asked, shapes, share), "Loading the model"
        )

    def stopped(self, context: bpy.types.Context) -> str:
        return "nothing was added"

    def finish(self, context: bpy.types.Context) -> set[str]:
        """Make the objects, select them, and say what happened."""
        from ...unisg_blender.runtime.wording import grouped

        result = self._result
        for line in result.reading.lines() if result.reading else ():
            self.report({"INFO"}, line)
        objects = bring_in(context, result)
        select_new(context, objects, (self.on, self.beside))
        for line in grouped((each.name or each.category, each.note) for each in result.objects if each.note):
            self.report({"WARNING"}, line)
        spent = time.perf_counter() - self._began
        added = f"{_number(result.added, 'object')} added{self._actions(result.actions) if result.added else ''}"
        refused = ""
        if result.refused:  # told here as well: the status bar shows the last report only
            reasons = sorted({placement.note for placement in result.refused})
            refused = f", {len(result.refused)} found no place: {'; '.join(reasons)}"
        level = "WARNING" if result.refused else "INFO"
        self.report({level}, f"{added} in {spent:.2f} s{refused} (seed {self.seed})")
        return {"FINISHED"} if result.added else {"CANCELLED"}

    def draw(self, context: bpy.types.Context) -> None:
        """What can be changed afterwards."""
        layout = self.layout
        layout.use_property_split = True
        wanted = [part.split("=") for part in self.add.split(",")]
        layout.label(text=", ".join(f"{count} {name}" for name, *count in wanted for count in [*count, "1"][:1]))
        for word, name in (("on", self.on), ("beside", self.beside), ("in room", self.within)):
            if name:
                layout.label(text=f"{word} {name}")
        for name in ("seed", "variety", "candidates", "bulk", "behaviour"):
            layout.prop(self, name)

    def _actions(self, count: int) -> str:
        """What is said of the actions that were asked for."""
        if not self.behaviour or not (count or looked_up(bpy.context.scene).lessons):
            return ""  # nobody asked for a lesson
        if load_generator(self.model).behaviour is None:
            return " (this model knows no actions)"
        return f" with {_number(count, 'action')}" if count else " (the lesson needs no further actions)"


def _generated(
    model: str, graph: SceneGraph, counts: dict[str, int], seed: int, asked: dict[str, Any],
    shapes: dict[str, list[Asset]], share: Share,
) -> Generated:  # fmt: skip
    """What a model makes of a scene; nothing of Blender's is touched."""
    total = sum(counts.values())
    generator = opened_generator(model)
    known = {next(iter(generator.understood({name: 1}, asked["words"]))): given for name, given in shapes.items()}
    placing, done = generator.steps(graph, counts, seed, shapes=known, **asked), 0
    share.tell(0.0, f"Generating {total} objects")
    while True:
        try:
            next(placing)
        except StopIteration as stop:
            result: Generated = stop.value
            return result
        done += 1
        share.tell(done / total, f"Generating {done} of {total}")


def _number(count: int, word: str) -> str:
    return f"{count} {word}{'s' * (count != 1)}"


CLASSES = (UNISG_OT_generate,)

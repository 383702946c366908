"""Place selected objects anew by the chosen model; the rest stays."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING

import bpy

from ...unisg_blender.errors import UniSGError
from ..base import SteppedOperator, Steps
from ..room.checking import check_again
from ..threaded_steps import Share, in_thread
from .generation_settings import opened_generator, read_words, scene_in_words, shipped_models
from .movable_objects import LINKED, movable
from .sampling_choices import SamplingChoices

if TYPE_CHECKING:
    from ...unisg_blender.generate.rerolled_scene import Rerolled


class UNISG_OT_reroll(SamplingChoices, SteppedOperator):
    """Give each selected object another place by the model; what stands on it moves along, the rest stays"""

    bl_idname = "unisg.reroll"
    bl_label = "Re-roll Selected"
    bl_options = {"REGISTER", "UNDO"}

    seed: bpy.props.IntProperty(
        name="Seed", description="The same seed gives the same places; -1 gives others each time",
        default=-1, min=-1, options={"SKIP_SAVE"},
    )  # fmt: skip
    model: bpy.props.StringProperty(
        name="Model",
        description="ONNX file or name of a shipped model; the panel's when empty",
        options={"HIDDEN", "SKIP_SAVE"},
    )
    words: bpy.props.StringProperty(name="Words", description="A mapping file", options={"HIDDEN", "SKIP_SAVE"})

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        if context.mode != "OBJECT":
            return "Leave edit mode first"
        meshes = [item for item in context.selected_objects if item.type == "MESH"]
        if not meshes:
            return "Select objects with meshes first"
        return "" if movable(meshes) else LINKED

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        settings = context.window_manager.unisg
        self.model, self.words = self.model or settings.model_file(), self.words or settings.words
        for name in ("variety", "candidates"):
            if not self.properties.is_property_set(name):
                setattr(self, name, getattr(settings, name))
        return super().invoke(context, event)

    def steps(self, context: bpy.types.Context) -> Steps:
        """Find a place for one object after another; nothing is moved before the end."""
        from ...unisg_blender.blender import objects_by_uid
        from ...unisg_blender.generate.rerolled_scene import reroll_steps

        shipped, mapping = shipped_models(), read_words(self.words)
        if not self.model and not shipped:
            raise UniSGError("no model came with this installation: choose one in the panel")
        if self.seed < 0:
            self.seed = random.randrange(2**31)
        graph, items = scene_in_words(context.scene, mapping), objects_by_uid(context.scene)
        chosen = set(movable(context.selected_objects))
        rows = [row for row, uid in enumerate(graph.uid) if items.get(uid) in chosen]
        model, seed, words = bpy.path.abspath(self.model or str(shipped[0])), self.seed, mapping.get("words", {})
        sampling = self.sampling()

        def placed(share: Share) -> list[Rerolled]:
            """All of them, one after another."""
            found = []
            for item in reroll_steps(opened_generator(model), graph, rows, seed, words, sampling):
                found.append(item)
                share.tell(min(len(found) / max(len(rows), 1), 1.0), f"Placing {len(found)}")
            return found

        self._graph = graph
        self._found = yield from in_thread(placed, "Loading the model")

    def stopped(self, context: bpy.types.Context) -> str:
        return "nothing was moved"

    def finish(self, context: bpy.types.Context) -> set[str]:
        """Move the objects, and say what found no other place."""
        from ...unisg_blender.blender.authoring.moved_objects import MovedObject, move_objects
        from ...unisg_blender.runtime.wording import grouped

        moved = [MovedObject(item.row, item.world, item.carrier, item.along) for item in self._found if not item.note]
        move_objects(context.scene, self._graph, moved)
        self.report({"INFO"}, f"{len(moved)} of {len(self._found)} placed anew (seed {self.seed})")
        for line in grouped((self._graph.name[item.row], item.note) for item in self._found if item.note):
            self.report({"WARNING"}, line)
        if moved:
            check_again()
        return {"FINISHED"} if moved else {"CANCELLED"}


CLASSES = (UNISG_OT_reroll,)

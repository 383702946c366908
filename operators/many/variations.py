"""Variations of the open scene as files or as a dataset."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy

from ...unisg_blender.errors import UniSGError
from ..making.generation_settings import shipped_models
from .batch_work import BatchDialog, BatchOperator

if TYPE_CHECKING:
    from ...unisg_blender.batches.batch_plan import BatchOptions, Task


class VariationChoices:
    """How many, of what kind, and what varies."""

    count: bpy.props.IntProperty(name="Count", description="How many to make", default=10, min=1, soft_max=1000)
    selection: bpy.props.EnumProperty(
        name="Selected",
        description="What becomes of the selected objects; what carries a padlock always stays",
        items=(
            ("REROLL", "Re-roll", "They get other places by the model, the rest stays where it is"),
            ("LOCK", "Lock", "They stay, all other things get other places"),
            ("SWAP", "Swap Shapes", "They get other shapes of their category where they stand"),
        ),
    )
    jitter: bpy.props.FloatProperty(
        name="Move the Rest", description="What stays is moved a little, so many metres at most, where that holds",
        default=0.0, min=0.0, max=1.0, subtype="DISTANCE",
    )  # fmt: skip
    format: bpy.props.EnumProperty(
        name="As",
        description="What is written",
        items=(
            ("blend", "Blender Files", ""), ("glb", "glTF Files", ""), ("usda", "USD Files", ""),
            ("json", "JSON Files", ""), ("dataset", "Dataset", "One dataset to train networks on"),
        ),
    )  # fmt: skip


class UNISG_OT_make_variations(VariationChoices, BatchOperator):
    """Make variations of the scene into a folder, by processes beside this one; the open scene stays as it is"""

    bl_idname = "unisg.make_variations"
    bl_label = "Make Variations"
    bl_options = {"REGISTER"}

    def batch(self, context: bpy.types.Context, copy: Path) -> tuple[list[Task], BatchOptions]:
        from ...unisg_blender.batches.batch_plan import BatchOptions, plan_rooms
        from ...unisg_blender.batches.room_makers import GENERATED
        from ...unisg_blender.runtime.atomic_files import checksum_of

        shipped = shipped_models()
        model = Path(context.window_manager.unisg.model_file() or (str(shipped[0]) if shipped else ""))
        if not model.name:
            raise UniSGError("no model came with this installation: choose one in the panel Generate")
        how = {"bulk": False, "settle": True, "behaviour": True, "on": "", "beside": "", "within": "", "words": {}}
        settings: dict[str, Any] = {
            "model": str(model.absolute()), "sha256": checksum_of(model), "add": None, "mapping": None, "assets": "",
            "variation": self._variation(context), "how": how,
        }  # fmt: skip
        return plan_rooms([copy], self.count, self.seed, ""), BatchOptions(GENERATED, settings, self.format)

    def _variation(self, context: bpy.types.Context) -> dict[str, Any]:
        """What varies, as a file of variations says it; things by their uids."""
        from ...unisg_blender.blender import objects_by_uid
        from ...unisg_blender.blender.authoring.object_locks import is_locked

        objects = objects_by_uid(context.scene)
        chosen = [uid for uid, item in objects.items() if item.select_get()]
        locked = [uid for uid, item in objects.items() if is_locked(item)]
        if not chosen and self.selection != "LOCK":
            raise UniSGError("select the objects that are to vary")
        record: dict[str, Any] = {"lock": locked}
        if self.selection == "LOCK":
            record = {"lock": sorted({*locked, *chosen}), "reroll": ["*"]}
        else:
            record["reroll" if self.selection == "REROLL" else "swap"] = chosen
        return record | ({"jitter": {"distance": self.jitter}} if self.jitter > 0 else {})


class UNISG_OT_make_variations_dialog(VariationChoices, BatchDialog):
    """Choose how many variations of the scene to make, into which folder, and what varies"""

    bl_idname = "unisg.make_variations_dialog"
    bl_label = "Make Variations..."
    starts = "make_variations"


CLASSES = (UNISG_OT_make_variations, UNISG_OT_make_variations_dialog)

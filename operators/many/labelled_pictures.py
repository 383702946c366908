"""Pictures of the open scene with masks, depth, boxes and the scenegraph of what each shows."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy

from .batch_work import BatchDialog, BatchOperator

if TYPE_CHECKING:
    from ...unisg_blender.batches.batch_plan import BatchOptions, Task


class PictureChoices:
    """From where, how large, by what."""

    views: bpy.props.StringProperty(
        name="Views",
        description="Such as eye=4,corners=1,dollhouse=1,turntable=8, or a category to look at: Chair=2; "
        "the cameras of the scene when empty",
    )
    width: bpy.props.IntProperty(name="Width", description="Pixels", default=512, min=1, max=16384, subtype="PIXEL")
    height: bpy.props.IntProperty(name="Height", description="Pixels", default=512, min=1, max=16384, subtype="PIXEL")
    engine: bpy.props.EnumProperty(
        name="Engine",
        description="What renders the pictures; masks and depth are exact with any",
        items=(("cycles", "Cycles", ""), ("workbench", "Workbench", ""), ("eevee", "EEVEE", "")),
    )
    samples: bpy.props.IntProperty(name="Samples", description="Of each pixel in Cycles", default=32, min=1, max=65536)


class UNISG_OT_render_labels(PictureChoices, BatchOperator):
    """Take pictures of the scene with labels into a folder, by a process beside this one"""

    bl_idname = "unisg.render_labels"
    bl_label = "Render with Labels"
    bl_options = {"REGISTER"}
    what = "scenes"

    def batch(self, context: bpy.types.Context, copy: Path) -> tuple[list[Task], BatchOptions]:
        from ...unisg_blender.batches.batch_plan import PICTURES, BatchOptions, plan_rooms
        from ...unisg_blender.batches.pictures.view_choice import parse_views

        settings: dict[str, Any] = {
            "views": parse_views(self.views) if self.views else None, "size": [self.width, self.height],
            "engine": self.engine, "samples": self.samples, "mapping": None, "assets": "",
        }  # fmt: skip
        (task,) = plan_rooms([copy], 1, 0, "")
        return [{**task, "room": copy.stem, "seed": self.seed}], BatchOptions("", settings, PICTURES, timeout=3600.0)

    def summary(self, failed: int) -> str:
        pictures = sum(len(record.get("pictures", ())) for record in self._records)
        return f"{pictures} pictures"


class UNISG_OT_render_labels_dialog(PictureChoices, BatchDialog):
    """Choose from where to take pictures with labels of the scene, and into which folder"""

    bl_idname = "unisg.render_labels_dialog"
    bl_label = "Render with Labels..."
    starts = "render_labels"


CLASSES = (UNISG_OT_render_labels, UNISG_OT_render_labels_dialog)

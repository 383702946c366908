"""A batch that begins with the open scene: a copy of it is given to processes, the window stays usable."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import bpy

from ...unisg_blender.errors import UniSGError
from ..base import RELATIVE, SLICE, Operator, SteppedOperator, Steps, redraw_views

if TYPE_CHECKING:
    from ...unisg_blender.batches.batch_plan import BatchOptions, Task

STATUS = "unisg_batch_status"


class BatchChoices:
    """Where to, and with which seed; and when that can be asked."""

    folder: bpy.props.StringProperty(
        name="Folder",
        description="Where it is written; // is the folder of this file",
        subtype="DIR_PATH",
        options=RELATIVE,
    )
    seed: bpy.props.IntProperty(name="Seed", description="The same seed makes the same", default=0, min=0)
    overwrite: bpy.props.BoolProperty(
        name="Overwrite", description="Replace what an earlier batch made in that folder", options={"SKIP_SAVE"}
    )

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        if context.mode != "OBJECT":
            return "Leave edit mode first"
        if getattr(context.window_manager, STATUS):
            return "A batch is running"
        return "" if context.scene.objects else "The scene is empty"


class BatchOperator(BatchChoices, SteppedOperator):
    """An operator that makes a batch of a copy of the open scene; Esc stops it, what was made stays."""

    what = "rooms"

    def batch(self, context: bpy.types.Context, copy: Path) -> tuple[list[Task], BatchOptions]:
        """What to make of the copy."""
        raise NotImplementedError

    def steps(self, context: bpy.types.Context) -> Steps:
        from ...unisg_blender.batches.batch_run import batch_steps

        out = absolute(self.folder)
        with TemporaryDirectory(prefix="unisg-batch-") as place:
            copy = Path(place, f"{_stem(context.scene)}.blend")
            bpy.ops.wm.save_as_mainfile(filepath=str(copy), copy=True, check_existing=False)
            tasks, options = self.batch(context, copy)
            self._records: list[dict[str, Any]] = []
            for records, total in batch_steps(tasks, out, options, overwrite=self.overwrite, wait=SLICE):
                self._records += records
                failed = sum(record["status"] == "failed" for record in self._records)
                words = f", {failed} failed" if failed else ""
                yield len(self._records) / max(total, 1), f"{len(self._records)} of {total} {self.what}{words}"

    def show(self, context: bpy.types.Context, share: float, text: str) -> None:
        super().show(context, share, text)
        setattr(context.window_manager, STATUS, text)
        redraw_views(context)

    def stopped(self, context: bpy.types.Context) -> str:
        return f"what was made is in {absolute(self.folder)}"

    def finish(self, context: bpy.types.Context) -> None:
        """Say how many there are, and why others are not."""
        bad = [record for record in self._records if record["status"] == "failed"]
        for record in bad[:3]:
            self.report({"WARNING"}, f"{record['source']}: {record['reason']}")
        self.report({"INFO"}, f"{self.summary(len(bad))} in {absolute(self.folder)}")

    def summary(self, failed: int) -> str:
        """What came of it."""
        return f"{len(self._records) - failed} of {len(self._records)} {self.what}"


class BatchDialog(BatchChoices, Operator):
    """An operator that asks for the choices of another one, ``starts``, and starts that."""

    starts = ""

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        return context.window_manager.invoke_props_dialog(self, width=360)

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        for name in _names(self):
            self.layout.prop(self, name)

    def run(self, context: bpy.types.Context) -> None:
        absolute(self.folder)
        given = {name: getattr(self, name) for name in _names(self)}
        getattr(bpy.ops.unisg, self.starts)("EXEC_DEFAULT" if bpy.app.background else "INVOKE_DEFAULT", **given)


def _names(operator: bpy.types.Operator) -> Iterator[str]:
    """The choices of an operator, in the order in which they are asked for."""
    known = (each.identifier for each in operator.properties.bl_rna.properties)
    return (name for name in known if name != "rna_type")


def absolute(path: str) -> str:
    """The folder that a user has chosen."""
    if not path:
        raise UniSGError("choose a folder")
    if path.startswith("//") and not bpy.data.filepath:
        raise UniSGError("save this file first, or choose a folder that does not begin with //")
    return bpy.path.abspath(path)


def _stem(scene: bpy.types.Scene) -> str:
    name = Path(bpy.data.filepath).stem if bpy.data.filepath else scene.name
    return bpy.path.clean_name(name) or "room"


CLASSES = ()
PROPERTIES = (
    (bpy.types.WindowManager, STATUS, bpy.props.StringProperty(name="Batch", description="What it is doing, or empty")),
)

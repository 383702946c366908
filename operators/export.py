"""Write the open scenes, or a folder of scene files, as a dataset for learning."""

from __future__ import annotations

import bpy

from ..unisg_blender.errors import UniSGError
from .base import RELATIVE, SLICE, SteppedOperator, Steps, redraw_views

FAILURES = "files-*.jsonl"
_form_items: list[tuple[str, str, str]] = []


def _forms(settings: object, context: bpy.types.Context | None) -> list[tuple[str, str, str]]:
    from ..unisg_blender.poses import FORMS

    names = sorted(FORMS, key=lambda name: name != "quaternion")  # the first one is the default
    _form_items[:] = [(name, name.replace("_", " ").capitalize(), f"{FORMS[name].width} features") for name in names]
    return _form_items  # Blender keeps no reference to the strings of a computed enum: we must


class DatasetSettings:
    """What the operator and the panel both ask for."""

    filepath: bpy.props.StringProperty(
        name="Folder",
        description="Folder of the dataset; // is the folder of this file",
        subtype="DIR_PATH",
        options=RELATIVE,
    )
    inputs: bpy.props.StringProperty(
        name="Files",
        description="Folder with scene files, searched with all below it; empty writes what is open here",
        subtype="DIR_PATH",
        options=RELATIVE,
    )
    form: bpy.props.EnumProperty(name="Form", description="How poses are represented in the dataset", items=_forms)
    instances: bpy.props.EnumProperty(
        name="Instances",
        description="What collections, geometry nodes and particles show",
        items=(
            ("realize", "As Objects", "Every copy is an object of the dataset"),
            ("keep", "Leave Out", "Copies are not in the dataset"),
        ),
    )
    understand: bpy.props.BoolProperty(
        name="Understand Names",
        description="Give things the category of their name, and floors, walls and ceilings theirs by geometry",
    )
    all_scenes: bpy.props.BoolProperty(name="All Scenes", description="Every scene of this file, not only this one")
    resume: bpy.props.BoolProperty(
        name="Resume", description="Go on with an export of files that was stopped, or bring its dataset up to date"
    )
    overwrite: bpy.props.BoolProperty(name="Replace", description="Replace a dataset that is in that folder already")


class UNISG_DatasetSettings(DatasetSettings, bpy.types.PropertyGroup):
    """The choices in the Dataset panel, and how far a running export is; they belong to the session."""

    status: bpy.props.StringProperty(
        name="Status", description="What a running export is doing, empty when there is none"
    )
    share: bpy.props.FloatProperty(name="Share", description="How much of it is done", min=0, max=1)


class UNISG_OT_export_dataset(DatasetSettings, SteppedOperator):
    """Write the open scene, or a folder of files, as a dataset to train networks on; no scene is changed"""

    bl_idname = "unisg.export_dataset"
    bl_label = "Export Dataset"
    bl_options = {"REGISTER"}

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        if context.mode != "OBJECT":
            return "Leave edit mode first"
        return "An export is running" if context.window_manager.unisg_dataset.status else ""

    def steps(self, context: bpy.types.Context) -> Steps:
        return self._file_steps() if self.inputs else self._scene_steps(context)

    def finish(self, context: bpy.types.Context) -> None:
        self.report({"INFO"}, self._summary)

    def stopped(self, context: bpy.types.Context) -> str:
        if not self.inputs:
            return "nothing was written"
        context.window_manager.unisg_dataset.resume = True  # what was read of files is kept
        return "export again to go on"

    def show(self, context: bpy.types.Context, share: float, text: str) -> None:
        super().show(context, share, text)
        settings = context.window_manager.unisg_dataset
        settings.share, settings.status = share, text
        redraw_views(context)

    def _scene_steps(self, context: bpy.types.Context) -> Steps:
        """Read what is open scene by scene, then write."""
        from ..unisg_blender.blender import read_scene
        from ..unisg_blender.dataset import Sample
        from ..unisg_blender.dataset.export.realized_instances import realize_objects
        from ..unisg_blender.dataset.format.writer import write_steps
        from ..unisg_blender.dataset.told_categories import told_categories

        folder = self._absolute(self.filepath)
        names = [scene.name for scene in (bpy.data.scenes if self.all_scenes else [context.scene]) if scene.objects]
        if not names:
            raise UniSGError("there are no objects to write")
        samples = []
        for number, name in enumerate(names):
            yield number / (2 * len(names)), f"Reading {name}"
            graph = read_scene(bpy.data.scenes[name])
            if self.instances == "realize":
                graph, _ = realize_objects(graph)
            if self.understand:
                graph = told_categories(graph)
            samples.append(Sample(graph, bpy.path.basename(bpy.data.filepath) or name))
        yield 0.5, "Writing"
        for done in write_steps(samples, folder, self.form, overwrite=self.overwrite):
            yield 0.5 + done / (2 * len(names)), "Writing"
        self._summary = f"{len(names)} scenes with {sum(len(item.graph) for item in samples)} entities in {folder}"

    def _file_steps(self) -> Steps:
        """Have files read by Blenders of their own; what is open here is not touched."""
        from ..unisg_blender.dataset.export.batch_export import ExportOptions, export_steps

        folder, inputs = self._absolute(self.filepath), self._absolute(self.inputs)
        options = ExportOptions(form=self.form, instances=self.instances, understand=self.understand)
        done = failed = 0
        steps = export_steps([inputs], folder, options, resume=self.resume, overwrite=self.overwrite, wait=SLICE)
        for record, total in steps:
            done += record is not None
            failed += record is not None and record["status"] == "failed"
            yield done / total, f"{done} of {total} files" + (f", {failed} could not be read" if failed else "")
        self._summary = f"{done - failed} of {done} files are in {folder}"
        if failed:
            self._summary += f"; {FAILURES} there says why {failed} could not be read"

    def _absolute(self, path: str) -> str:
        if not path:
            raise UniSGError("choose a folder for the dataset")
        if path.startswith("//") and not bpy.data.filepath:
            raise UniSGError("save this file first, or choose a folder that does not begin with //")
        return bpy.path.abspath(path)


CLASSES = (UNISG_DatasetSettings, UNISG_OT_export_dataset)
PROPERTIES = ((bpy.types.WindowManager, "unisg_dataset", bpy.props.PointerProperty(type=UNISG_DatasetSettings)),)

"""Write the open scenes, or a folder of scene files, as a dataset for learning."""

from __future__ import annotations

import time
from collections.abc import Iterator

import bpy

WAIT = 0.05
"""Seconds of work, or of waiting for a file, between two redraws: the window stays responsive."""

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
        name="Folder", description="Folder of the dataset; // is the folder of this file", subtype="DIR_PATH"
    )
    inputs: bpy.props.StringProperty(
        name="Files",
        description="Folder with scene files, searched with all below it; empty writes what is open here",
        subtype="DIR_PATH",
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


class UNISG_OT_export_dataset(DatasetSettings, bpy.types.Operator):
    """Write the open scene, or a folder of files, as a dataset to train networks on; no scene is changed"""

    bl_idname = "unisg.export_dataset"
    bl_label = "Export Dataset"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.mode != "OBJECT":
            cls.poll_message_set("Leave edit mode first")
            return False
        if context.window_manager.unisg_dataset.status:
            cls.poll_message_set("An export is running")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        from ..unisg_blender.errors import UniSGError

        try:
            for _ in self._steps(context):
                pass
        except UniSGError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return self._done()

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        self._work = self._steps(context)
        self._timer = context.window_manager.event_timer_add(0.01, window=context.window)
        context.window_manager.progress_begin(0, 1)
        self._show(context, 0.0, "Starting")
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        from ..unisg_blender.errors import UniSGError

        if event.type == "ESC":
            self._work.close()  # what it wrote goes away with it, but what is read of files
            self._end(context)
            if self.inputs:
                context.window_manager.unisg_dataset.resume = True
            self.report({"INFO"}, f"Stopped; {'export again to go on' if self.inputs else 'nothing was written'}")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}
        try:
            share, text = self._work_on()
        except StopIteration:
            self._end(context)
            return self._done()
        except UniSGError as error:
            self._end(context)
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self._show(context, share, text)
        return {"RUNNING_MODAL"}

    def _work_on(self) -> tuple[float, str]:
        """Work for a moment, not for one file only: a redraw may take longer than a file that is known already."""
        end = time.perf_counter() + WAIT
        while True:
            done = next(self._work)
            if time.perf_counter() >= end:
                return done

    def _show(self, context: bpy.types.Context, share: float, text: str) -> None:
        settings = context.window_manager.unisg_dataset
        settings.share, settings.status = share, text
        context.window_manager.progress_update(share)
        context.workspace.status_text_set(f"{text}   ESC: stop")
        for area in context.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()

    def _steps(self, context: bpy.types.Context) -> Iterator[tuple[float, str]]:
        """Yields how much is done, 0 to 1, and in words."""
        return self._file_steps() if self.inputs else self._scene_steps(context)

    def _scene_steps(self, context: bpy.types.Context) -> Iterator[tuple[float, str]]:
        """Read what is open scene by scene, then write."""
        from ..unisg_blender.blender import read_scene
        from ..unisg_blender.dataset import Sample
        from ..unisg_blender.dataset.export.realized_instances import realize_objects
        from ..unisg_blender.dataset.format.writer import write_steps
        from ..unisg_blender.errors import UniSGError

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
            samples.append(Sample(graph, bpy.path.basename(bpy.data.filepath) or name))
        yield 0.5, "Writing"
        for done in write_steps(samples, folder, self.form, overwrite=self.overwrite):
            yield 0.5 + done / (2 * len(names)), "Writing"
        self._summary = f"{len(names)} scenes with {sum(len(item.graph) for item in samples)} entities in {folder}"

    def _file_steps(self) -> Iterator[tuple[float, str]]:
        """Have files read by Blenders of their own; what is open here is not touched."""
        from ..unisg_blender.dataset.export.batch_export import ExportOptions, export_steps

        folder, inputs = self._absolute(self.filepath), self._absolute(self.inputs)
        options = ExportOptions(form=self.form, instances=self.instances)
        done = failed = 0
        steps = export_steps([inputs], folder, options, resume=self.resume, overwrite=self.overwrite, wait=WAIT)
        for record, total in steps:
            done += record is not None
            failed += record is not None and record["status"] == "failed"
            yield done / total, f"{done} of {total} files" + (f", {failed} could not be read" if failed else "")
        self._summary = f"{done - failed} of {done} files are in {folder}"
        if failed:
            self._summary += f"; {FAILURES} there says why {failed} could not be read"

    def _absolute(self, path: str) -> str:
        from ..unisg_blender.errors import UniSGError

        if not path:
            raise UniSGError("choose a folder for the dataset")
        if path.startswith("//") and not bpy.data.filepath:
            raise UniSGError("save this file first, or choose a folder that does not begin with //")
        return bpy.path.abspath(path)

    def _end(self, context: bpy.types.Context) -> None:
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        self._show(context, 0.0, "")
        context.workspace.status_text_set(None)

    def _done(self) -> set[str]:
        self.report({"INFO"}, self._summary)
        return {"FINISHED"}


CLASSES = (UNISG_DatasetSettings, UNISG_OT_export_dataset)


def register() -> None:
    """Add the settings to the window manager."""
    bpy.types.WindowManager.unisg_dataset = bpy.props.PointerProperty(type=UNISG_DatasetSettings)


def unregister() -> None:
    """Take them away."""
    del bpy.types.WindowManager.unisg_dataset

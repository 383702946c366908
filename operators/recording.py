"""Record how things are moved, into a USD file, and replay recordings onto the scene."""

from __future__ import annotations

import time

import bpy

FILES = "*.usd;*.usda;*.usdc;*.usdz"
EVERY = 1 / 30


def _poll(cls: type, context: bpy.types.Context) -> bool:
    from ..unisg_blender.usd.library import missing_pxr

    reason = "" if context.scene.objects else "The scene has no objects"
    reason = reason or missing_pxr()
    if reason:
        cls.poll_message_set(reason)
    return not reason


class UNISG_OT_record(bpy.types.Operator):
    """Record while you move things; Esc or Enter stops and saves. From a script: record the playback"""

    bl_idname = "unisg.record"
    bl_label = "Record Motion"
    bl_options = {"REGISTER"}

    filepath: bpy.props.StringProperty(name="File", subtype="FILE_PATH", default="//recording.usdc")
    millimetres: bpy.props.FloatProperty(
        name="Millimetres", description="How far a sample may be off", default=0.5, min=0
    )
    degrees: bpy.props.FloatProperty(name="Degrees", description="How far a sample may be turned", default=0.1, min=0)

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return _poll(cls, context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        from ..unisg_blender.blender.recording import record_playback

        return self._save(record_playback(context.scene))

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        from ..unisg_blender.blender.recording import Recorder

        self._recorder, self._scene, self._start = Recorder(), context.scene.name, time.monotonic()
        self._recorder.sample(context.scene, 0.0)
        self._timer = context.window_manager.event_timer_add(EVERY, window=context.window)
        context.window_manager.modal_handler_add(self)
        context.workspace.status_text_set("Recording: move things; Esc or Enter stops")
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        scene = bpy.data.scenes.get(self._scene)
        if scene is None or (event.type in {"ESC", "RET"} and event.value == "PRESS"):
            self.cancel(context)
            return {"CANCELLED"} if scene is None else self._finish(scene)
        if event.type == "TIMER":
            self._recorder.sample(scene, time.monotonic() - self._start)
        return {"PASS_THROUGH"}

    def cancel(self, context: bpy.types.Context) -> None:
        context.window_manager.event_timer_remove(self._timer)
        context.workspace.status_text_set(None)

    def _finish(self, scene: bpy.types.Scene) -> set[str]:
        from ..unisg_blender.blender import read_scene

        return self._save(self._recorder.recorded(read_scene(scene), self.millimetres, self.degrees))

    def _save(self, graph: object) -> set[str]:
        from ..unisg_blender.errors import UniSGError
        from ..unisg_blender.usd import write_usd

        found = graph.components.get("recording")
        if found is None:
            self.report({"WARNING"}, "Nothing moved: no file was written")
            return {"CANCELLED"}
        try:
            write_usd(graph, bpy.path.abspath(self.filepath))
        except UniSGError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.report({"INFO"}, f"{len(found.rows)} objects recorded")
        return {"FINISHED"}


class UNISG_OT_replay(bpy.types.Operator):
    """Set a recording as keyframes of the objects that it was made of"""

    bl_idname = "unisg.replay"
    bl_label = "Replay Recording"
    bl_options = {"REGISTER", "UNDO"}

    filepath: bpy.props.StringProperty(name="File", subtype="FILE_PATH")
    filter_glob: bpy.props.StringProperty(default=FILES, options={"HIDDEN"})

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return _poll(cls, context)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        from ..unisg_blender.blender.recording import replay
        from ..unisg_blender.errors import UniSGError
        from ..unisg_blender.usd import read_usd

        try:
            count = replay(read_usd(bpy.path.abspath(self.filepath)), context.scene)
        except UniSGError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.report({"INFO"}, f"{count} objects move as recorded")
        return {"FINISHED"}


CLASSES = (UNISG_OT_record, UNISG_OT_replay)

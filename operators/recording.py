"""Record how objects are moved and what a lesson makes of it, keep it in the scene or a file, and replay it."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import bpy

from .play import session

FILES = "*.usd;*.usda;*.usdc;*.usdz"
EVERY = 1 / 30


@dataclass
class RecordingTake:
    """A recording that is being made: of which scene, since when, the recorder, and the lesson played meanwhile."""

    scene: str
    began: float
    recorder: Any
    lesson: Any = None
    stopped: bool = False

    def look(self) -> None:
        """Take down where objects are now."""
        self.lesson = session() or self.lesson
        self.recorder.sample(bpy.data.scenes[self.scene], time.monotonic() - self.began)

    def graph(self, millimetres: float, degrees: float) -> Any:
        """The scenegraph with everything recorded."""
        from ..unisg_blender.behaviour.record.recorded_events import later, with_events
        from ..unisg_blender.blender import read_scene

        graph = self.recorder.recorded(read_scene(bpy.data.scenes[self.scene]), millimetres, degrees)
        if self.lesson is None:
            return with_events(graph, (), ())
        late = self.lesson.started - self.began
        return with_events(graph, later(self.lesson.events, late), later(self.lesson.inputs, late))


_takes: list[RecordingTake] = []


def take() -> RecordingTake | None:
    """The recording that is being made, None if none is."""
    return _takes[-1] if _takes else None


def _missing_usd(path: str) -> str:
    from ..unisg_blender.usd.pxr_library import missing_pxr

    return missing_pxr() if path else ""


class UNISG_OT_record(bpy.types.Operator):
    """Record while you move objects, and play a lesson; Esc, Enter or the button stops"""

    bl_idname = "unisg.record"
    bl_label = "Record Motion"
    bl_options = {"UNDO"}  # no REGISTER: to adjust it afterwards would record the playback in its place

    filepath: bpy.props.StringProperty(
        name="File", subtype="FILE_PATH", description="A USD file to write as well; the scene alone keeps it when empty"
    )
    millimetres: bpy.props.FloatProperty(
        name="Millimetres", description="How far a sample may be off", default=0.5, min=0
    )
    degrees: bpy.props.FloatProperty(name="Degrees", description="How far a sample may be turned", default=0.1, min=0)
    playback: bpy.props.BoolProperty(
        name="Playback",
        description="Record the animation, not what you do; a script records that anyway",
        options={"SKIP_SAVE"},
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        if properties.playback:
            return "Step through the animation from start to end and record it, the lesson along with it"
        return cls.__doc__

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        reason = "" if context.scene.objects else "The scene has no objects"
        reason = reason or ("A recording is being made" if take() is not None else "")
        if reason:
            cls.poll_message_set(reason)
        return not reason

    def execute(self, context: bpy.types.Context) -> set[str]:
        from ..unisg_blender.blender.motion.scene_recording import record_playback
        from ..unisg_blender.errors import UniSGError

        try:
            return self._save(context.scene, record_playback(context.scene))
        except UniSGError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        from ..unisg_blender.blender.motion.scene_recording import SceneRecorder

        if self.playback:
            return self.execute(context)
        reason = _missing_usd(self.filepath)
        if reason:
            self.report({"ERROR"}, reason)
            return {"CANCELLED"}
        _takes[:] = [RecordingTake(context.scene.name, time.monotonic(), SceneRecorder())]
        _takes[0].look()
        self._timer = context.window_manager.event_timer_add(EVERY, window=context.window)
        context.window_manager.modal_handler_add(self)
        context.workspace.status_text_set("Recording: move things; Esc or Enter stops")
        _redraw(context)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        current = take()
        if current is not None and current.scene not in bpy.data.scenes:
            self.cancel(context)
            return {"CANCELLED"}
        if current is None or current.stopped or (event.type in {"ESC", "RET"} and event.value == "PRESS"):
            self.cancel(context)
            return {"CANCELLED"} if current is None else self._finish(current)
        if event.type == "TIMER":
            current.look()
        return {"PASS_THROUGH"}

    def cancel(self, context: bpy.types.Context) -> None:
        """It ends, or Blender closes its window."""
        _takes.clear()
        context.window_manager.event_timer_remove(self._timer)
        context.workspace.status_text_set(None)
        _redraw(context)

    def _finish(self, current: RecordingTake) -> set[str]:
        current.look()
        scene = bpy.data.scenes[current.scene]
        return self._save(scene, current.graph(self.millimetres, self.degrees))

    def _save(self, scene: bpy.types.Scene, graph: Any) -> set[str]:
        from ..unisg_blender.blender import ReadReport
        from ..unisg_blender.blender.motion.scene_recording import store_recording
        from ..unisg_blender.errors import UniSGError

        moved, events = (graph.components.get(name) for name in ("recording", "events"))
        if (moved is None or not len(moved.rows)) and (events is None or not len(events.rows)):
            self.report({"WARNING"}, "Nothing moved: nothing was recorded")
            return {"CANCELLED"}
        report = ReadReport()
        try:
            if self.filepath:
                from ..unisg_blender.usd import write_usd

                write_usd(graph, bpy.path.abspath(self.filepath))
            store_recording(graph, scene, report)
        except UniSGError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if len(report):
            self.report({"WARNING"}, f"Not recorded: {report.summary()}")
        counts = [0 if each is None else len(each.rows) for each in (moved, events)]
        self.report({"INFO"}, f"{counts[0]} objects and {counts[1]} events recorded")
        return {"FINISHED"}


def _redraw(context: bpy.types.Context) -> None:
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


class UNISG_OT_record_stop(bpy.types.Operator):
    """Stop recording and keep what was recorded"""

    bl_idname = "unisg.record_stop"
    bl_label = "Stop Recording"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if take() is None:
            cls.poll_message_set("No recording is being made")
        return take() is not None

    def execute(self, context: bpy.types.Context) -> set[str]:
        take().stopped = True
        return {"FINISHED"}


class UNISG_OT_record_clear(bpy.types.Operator):
    """Forget what was recorded of the objects of this scene"""

    bl_idname = "unisg.record_clear"
    bl_label = "Clear Recording"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        from ..unisg_blender.blender.motion.scene_recording import clear_recording

        clear_recording(context.scene)
        return {"FINISHED"}


class Replay:
    """Replays the recording of a file, or of the scene itself."""

    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        from ..unisg_blender.blender.motion.scene_recording import replay
        from ..unisg_blender.errors import UniSGError

        try:
            count = replay(_recorded(context.scene, self.filepath), context.scene)
        except UniSGError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.report({"INFO"}, f"{count} objects move as recorded")
        return {"FINISHED"}


def _recorded(scene: bpy.types.Scene, path: str) -> Any:
    from ..unisg_blender.blender import read_scene
    from ..unisg_blender.errors import UniSGError

    if not path:
        return read_scene(scene, geometry="none", details=False)
    reason = _missing_usd(path)
    if reason:
        raise UniSGError(reason)
    from ..unisg_blender.usd import read_usd

    return read_usd(bpy.path.abspath(path))


class UNISG_OT_replay(Replay, bpy.types.Operator):
    """Set the recording as keyframes of the objects that it was made of, its events as markers on the timeline"""

    bl_idname = "unisg.replay"
    bl_label = "Replay Recording"

    filepath: bpy.props.StringProperty(
        name="File", subtype="FILE_PATH", description="A USD file; the scene's own recording when empty"
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not context.scene.objects:
            cls.poll_message_set("The scene has no objects")
        return bool(context.scene.objects)


class UNISG_OT_replay_file(Replay, bpy.types.Operator):
    """Choose a USD file and replay the recording in it"""

    bl_idname = "unisg.replay_file"
    bl_label = "Replay File"

    filepath: bpy.props.StringProperty(name="File", subtype="FILE_PATH")
    filter_glob: bpy.props.StringProperty(default=FILES, options={"HIDDEN"})

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        reason = "" if context.scene.objects else "The scene has no objects"
        reason = reason or _missing_usd("any file")
        if reason:
            cls.poll_message_set(reason)
        return not reason

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}


CLASSES = (
    UNISG_OT_record,
    UNISG_OT_record_stop,
    UNISG_OT_record_clear,
    UNISG_OT_replay,
    UNISG_OT_replay_file,
)


def unregister() -> None:
    """Forget what was being recorded; the running operator ends at its next event."""
    _takes.clear()

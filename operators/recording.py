"""Record how objects are moved and what a lesson makes of it, keep it in the scene or a file, and replay it."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import bpy

from ..unisg_blender.errors import UniSGError
from .base import FileOperator, Operator, redraw_views
from .play import session

if TYPE_CHECKING:
    from ..unisg_blender.blender.motion.scene_recording import SceneRecorder
    from ..unisg_blender.blender.viewport.lesson_session import Session
    from ..unisg_blender.scene import SceneGraph

FILES = "*.usd;*.usda;*.usdc;*.usdz"
EVERY = 1 / 30


@dataclass
class RecordingTake:
    """A recording that is being made: of which scene, since when, the recorder, and the lesson played meanwhile."""

    scene: str
    began: float
    recorder: SceneRecorder
    lesson: Session | None = None
    stopped: bool = False

    def look(self) -> None:
        """Take down where objects are now."""
        self.lesson = session() or self.lesson
        self.recorder.sample(bpy.data.scenes[self.scene], time.monotonic() - self.began)

    def graph(self, millimetres: float, degrees: float) -> SceneGraph:
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


def _without_objects(context: bpy.types.Context) -> str:
    return "" if context.scene.objects else "The scene has no objects"


class UNISG_OT_record(Operator):
    """Record while you move objects, and play a lesson; Esc, Enter or the button stops"""

    bl_idname = "unisg.record"
    bl_label = "Record Motion"
    bl_options = {"UNDO"}  # no REGISTER: to adjust it afterwards would record the playback in its place

    filepath: bpy.props.StringProperty(
        name="File", subtype="FILE_PATH", options={"SKIP_SAVE"},
        description="A USD file to write as well; the scene alone keeps it when empty",
    )  # fmt: skip
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
        return str(cls.__doc__)

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return _without_objects(context) or ("A recording is being made" if take() is not None else "")

    def run(self, context: bpy.types.Context) -> set[str]:
        from ..unisg_blender.blender.motion.scene_recording import record_playback

        return self._save(context.scene, record_playback(context.scene))

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        return self.execute(context) if self.playback else self.reporting(self._begin, context)

    def _begin(self, context: bpy.types.Context) -> set[str]:
        from ..unisg_blender.blender.motion.scene_recording import SceneRecorder

        if reason := _missing_usd(self.filepath):
            raise UniSGError(reason)
        _takes[:] = [RecordingTake(context.scene.name, time.monotonic(), SceneRecorder())]
        _takes[0].look()
        self._timer = context.window_manager.event_timer_add(EVERY, window=context.window)
        context.window_manager.modal_handler_add(self)
        context.workspace.status_text_set("Recording: move things; Esc or Enter stops")
        redraw_views(context)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        current = take()
        if current is not None and current.scene not in bpy.data.scenes:
            self.cancel(context)
            return {"CANCELLED"}
        if current is None or current.stopped or (event.type in {"ESC", "RET"} and event.value == "PRESS"):
            self.cancel(context)
            return {"CANCELLED"} if current is None else self.reporting(self._finish, current)
        if event.type == "TIMER":
            current.look()
        return {"PASS_THROUGH"}

    def cancel(self, context: bpy.types.Context) -> None:
        """It ends, or Blender closes its window."""
        _takes.clear()
        context.window_manager.event_timer_remove(self._timer)
        context.workspace.status_text_set(None)
        redraw_views(context)

    def _finish(self, current: RecordingTake) -> set[str]:
        current.look()
        return self._save(bpy.data.scenes[current.scene], current.graph(self.millimetres, self.degrees))

    def _save(self, scene: bpy.types.Scene, graph: SceneGraph) -> set[str]:
        from ..unisg_blender.blender import ReadReport
        from ..unisg_blender.blender.motion.scene_recording import store_recording

        moved, events = (graph.components.get(name) for name in ("recording", "events"))
        if (moved is None or not len(moved.rows)) and (events is None or not len(events.rows)):
            self.report({"WARNING"}, "Nothing moved: nothing was recorded")
            return {"CANCELLED"}
        report = ReadReport()
        if self.filepath:
            from ..unisg_blender.usd import write_usd

            write_usd(graph, bpy.path.abspath(self.filepath))
        store_recording(graph, scene, report)
        if len(report):
            self.report({"WARNING"}, f"Not recorded: {report.summary(most=3)}")
        counts = [0 if each is None else len(each.rows) for each in (moved, events)]
        self.report({"INFO"}, f"{counts[0]} objects and {counts[1]} events recorded")
        return {"FINISHED"}


class UNISG_OT_record_stop(Operator):
    """Stop recording and keep what was recorded"""

    bl_idname = "unisg.record_stop"
    bl_label = "Stop Recording"
    bl_options = {"INTERNAL"}

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return "" if _takes else "No recording is being made"

    def run(self, context: bpy.types.Context) -> None:
        _takes[-1].stopped = True


class UNISG_OT_record_clear(Operator):
    """Forget what was recorded of the objects of this scene"""

    bl_idname = "unisg.record_clear"
    bl_label = "Clear Recording"
    bl_options = {"REGISTER", "UNDO"}

    def run(self, context: bpy.types.Context) -> None:
        from ..unisg_blender.blender.motion.scene_recording import clear_recording

        clear_recording(context.scene)


class UNISG_OT_replay(Operator):
    """Set the recording as keyframes of the objects that it was made of, its events as markers on the timeline"""

    bl_idname = "unisg.replay"
    bl_label = "Replay Recording"
    bl_options = {"REGISTER", "UNDO"}

    filepath: bpy.props.StringProperty(
        name="File", subtype="FILE_PATH", description="A USD file; the scene's own recording when empty",
        options={"SKIP_SAVE"},
    )  # fmt: skip

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return _without_objects(context)

    def run(self, context: bpy.types.Context) -> None:
        self.report({"INFO"}, _replay(context.scene, self.filepath))


class UNISG_OT_replay_file(FileOperator):
    """Choose a USD file and replay the recording in it"""

    bl_idname = "unisg.replay_file"
    bl_label = "Replay File"
    bl_options = {"REGISTER", "UNDO"}

    filter_glob: bpy.props.StringProperty(default=FILES, options={"HIDDEN"})

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return _without_objects(context) or _missing_usd("any file")

    def run(self, context: bpy.types.Context) -> None:
        self.report({"INFO"}, _replay(context.scene, self.filepath))


def _replay(scene: bpy.types.Scene, path: str) -> str:
    """Replay the recording of a file, or of the scene itself; returns what to say."""
    from ..unisg_blender.blender import read_scene
    from ..unisg_blender.blender.motion.scene_recording import replay
    from ..unisg_blender.usd import read_usd

    if path and (reason := _missing_usd(path)):
        raise UniSGError(reason)
    graph = read_usd(bpy.path.abspath(path)) if path else read_scene(scene, geometry="none", details=False)
    return f"{replay(graph, scene)} objects move as recorded"


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

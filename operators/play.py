"""Play a lesson in the viewport: move objects, and see what is done and what comes next."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import bpy

from .base import Operator, redraw_views
from .scene_lookup import looked_up

if TYPE_CHECKING:
    from ..unisg_blender.blender.viewport.lesson_session import Session

STEP = 1 / 15
_sessions: list[Session] = []


def session() -> Session | None:
    """The lesson that is being played, None if none is."""
    return _sessions[-1] if _sessions else None


class UNISG_OT_play(Operator):
    """Play the lesson: move objects in the viewport; conditions turn green, stages advance (Escape ends it)"""

    bl_idname = "unisg.play"
    bl_label = "Play Lesson"

    operation: bpy.props.StringProperty(name="Lesson", description="Name or uid; the only one when empty")

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        if session() is not None:
            return "A lesson is being played"
        return "" if looked_up(context.scene).lessons else "The scene has no lesson: add one below"

    def run(self, context: bpy.types.Context) -> None:
        """Without a window: play the scene's animation through."""
        from ..unisg_blender.behaviour import simulate
        from ..unisg_blender.blender.authoring.stored_behaviour import scene_moments
        from ..unisg_blender.blender.viewport.lesson_session import open_session

        lesson = open_session(context.scene, self.operation).lesson
        timeline = simulate(lesson, scene_moments(context.scene, lesson.graph))
        for event in timeline.performed():
            self.report({"INFO"}, f"{event.time:.2f} s: {event.name}: {event.why}")
        self.report({"INFO"}, "Played to the end" if timeline.finished else "The lesson is not finished")

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        return self.reporting(self._begin, context)

    def _begin(self, context: bpy.types.Context) -> set[str]:
        from ..unisg_blender.blender.viewport.lesson_session import open_session

        _sessions[:] = [open_session(context.scene, self.operation)]
        _sessions[0].started = time.monotonic()
        self._finished = False
        self._timer = context.window_manager.event_timer_add(STEP, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        current = session()
        if current is None or event.type == "ESC" or current.scene not in bpy.data.scenes:
            return self._end(context)
        if event.type == "TIMER":
            before, events = current.face(), current.step(time.monotonic() - current.started)
            self._finished = current.state.finished
            for happened in events:
                if happened.kind in ("out_of_order", "wrong_answer"):
                    self.report({"WARNING"}, happened.why)
            if events or current.face() != before:  # buttons that are drawn again and again are hard to press
                redraw_views(context)
        return {"PASS_THROUGH"}

    def _end(self, context: bpy.types.Context) -> set[str]:
        context.window_manager.event_timer_remove(self._timer)
        _sessions.clear()
        self.report({"INFO"}, "The lesson has ended" if self._finished else "Stopped before the end")
        redraw_views(context)
        return {"FINISHED"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Blender closes its window."""
        _sessions.clear()


class PlayingOperator(Operator):
    """An operator that only works while a lesson is played."""

    bl_options = {"INTERNAL"}

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        return "" if _sessions else "No lesson is being played"


class UNISG_OT_play_stop(PlayingOperator):
    """Stop playing; objects stay where they are"""

    bl_idname = "unisg.play_stop"
    bl_label = "Stop"

    def run(self, context: bpy.types.Context) -> None:
        _sessions.clear()


class UNISG_OT_play_trigger(PlayingOperator):
    """Press or release the trigger of this tool"""

    bl_idname = "unisg.play_trigger"
    bl_label = "Trigger"

    uid: bpy.props.StringProperty()

    def run(self, context: bpy.types.Context) -> None:
        _sessions[-1].pressed ^= {self.uid}


class UNISG_OT_play_choose(PlayingOperator):
    """Tick this answer"""

    bl_idname = "unisg.play_choose"
    bl_label = "Choose"

    uid: bpy.props.StringProperty()
    place: bpy.props.IntProperty()
    several: bpy.props.BoolProperty()

    def run(self, context: bpy.types.Context) -> None:
        chosen = set(_sessions[-1].chosen.get(self.uid, ()))
        _sessions[-1].chosen[self.uid] = tuple(sorted(chosen ^ {self.place} if self.several else {self.place}))
        if not self.several:
            _sessions[-1].answer(self.uid)


class UNISG_OT_play_answer(PlayingOperator):
    """Give the ticked answers"""

    bl_idname = "unisg.play_answer"
    bl_label = "Answer"

    uid: bpy.props.StringProperty()

    def run(self, context: bpy.types.Context) -> None:
        _sessions[-1].answer(self.uid)


CLASSES = (UNISG_OT_play, UNISG_OT_play_stop, UNISG_OT_play_trigger, UNISG_OT_play_choose, UNISG_OT_play_answer)


def unregister() -> None:
    """Forget what was played; the running operator ends at its next event."""
    _sessions.clear()

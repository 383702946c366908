"""Play a lesson in the viewport: move objects, and see what is done and what comes next."""

from __future__ import annotations

import time
from typing import Any

import bpy

STEP = 1 / 15
_sessions: list[Any] = []


def session() -> Any:
    """The lesson that is being played, None if none is."""
    return _sessions[-1] if _sessions else None


def _redraw(context: bpy.types.Context) -> None:
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


class UNISG_OT_play(bpy.types.Operator):
    """Play the lesson: move objects in the viewport; conditions turn green, stages advance (Escape ends it)"""

    bl_idname = "unisg.play"
    bl_label = "Play Lesson"

    operation: bpy.props.StringProperty(name="Lesson", description="Name or uid; the only one when empty")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        from ..unisg_blender.blender.authoring.authoring import lesson_objects

        if session() is not None:
            cls.poll_message_set("A lesson is being played")
            return False
        if not lesson_objects(context.scene):
            cls.poll_message_set("The scene has no lesson: add one below")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Without a window: play the scene's animation through."""
        from ..unisg_blender.behaviour import simulate
        from ..unisg_blender.blender.authoring.stored_behaviour import scene_moments
        from ..unisg_blender.blender.viewport.lesson_session import open_session
        from ..unisg_blender.errors import UniSGError

        try:
            lesson = open_session(context.scene, self.operation).lesson
        except UniSGError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        timeline = simulate(lesson, scene_moments(context.scene, lesson.graph))
        for event in timeline.performed():
            self.report({"INFO"}, f"{event.time:.2f} s: {event.name}: {event.why}")
        self.report({"INFO"}, "Played to the end" if timeline.finished else "The lesson is not finished")
        return {"FINISHED"}

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        from ..unisg_blender.blender.viewport.lesson_session import open_session
        from ..unisg_blender.errors import UniSGError

        try:
            _sessions[:] = [open_session(context.scene, self.operation)]
        except UniSGError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        session().started = time.monotonic()
        self._timer = context.window_manager.event_timer_add(STEP, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        current = session()
        if current is None or event.type == "ESC" or current.scene not in bpy.data.scenes:
            return self._end(context)
        if event.type == "TIMER":
            before, events = current.face(), current.step(time.monotonic() - current.started)
            for happened in events:
                if happened.kind in ("out_of_order", "wrong_answer"):
                    self.report({"WARNING"}, happened.why)
            if events or current.face() != before:  # buttons that are drawn again and again are hard to press
                _redraw(context)
        return {"PASS_THROUGH"}

    def _end(self, context: bpy.types.Context) -> set[str]:
        context.window_manager.event_timer_remove(self._timer)
        finished = session() is not None and session().state.finished
        _sessions.clear()
        self.report({"INFO"}, "Played to the end" if finished else "Stopped before the end")
        _redraw(context)
        return {"FINISHED"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Blender closes its window."""
        _sessions.clear()


class PlayingOperator:
    """An operator that only works while a lesson is played."""

    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if session() is None:
            cls.poll_message_set("No lesson is being played")
        return session() is not None


class UNISG_OT_play_stop(PlayingOperator, bpy.types.Operator):
    """Stop playing; objects stay where they are"""

    bl_idname = "unisg.play_stop"
    bl_label = "Stop"

    def execute(self, context: bpy.types.Context) -> set[str]:
        _sessions.clear()
        return {"FINISHED"}


class UNISG_OT_play_trigger(PlayingOperator, bpy.types.Operator):
    """Press or release the trigger of this tool"""

    bl_idname = "unisg.play_trigger"
    bl_label = "Trigger"

    uid: bpy.props.StringProperty()

    def execute(self, context: bpy.types.Context) -> set[str]:
        session().pressed ^= {self.uid}
        return {"FINISHED"}


class UNISG_OT_play_choose(PlayingOperator, bpy.types.Operator):
    """Tick this answer"""

    bl_idname = "unisg.play_choose"
    bl_label = "Choose"

    uid: bpy.props.StringProperty()
    place: bpy.props.IntProperty()
    several: bpy.props.BoolProperty()

    def execute(self, context: bpy.types.Context) -> set[str]:
        chosen = set(session().chosen.get(self.uid, ()))
        session().chosen[self.uid] = tuple(sorted(chosen ^ {self.place} if self.several else {self.place}))
        if not self.several:
            session().answer(self.uid)
        return {"FINISHED"}


class UNISG_OT_play_answer(PlayingOperator, bpy.types.Operator):
    """Give the ticked answers"""

    bl_idname = "unisg.play_answer"
    bl_label = "Answer"

    uid: bpy.props.StringProperty()

    def execute(self, context: bpy.types.Context) -> set[str]:
        session().answer(self.uid)
        return {"FINISHED"}


CLASSES = (UNISG_OT_play, UNISG_OT_play_stop, UNISG_OT_play_trigger, UNISG_OT_play_choose, UNISG_OT_play_answer)


def unregister() -> None:
    """Forget what was played; the running operator ends at its next event."""
    _sessions.clear()

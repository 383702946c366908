"""What our operators share: they say why they are grey, report what a user can mend, and work between redraws."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Generator, Sequence
from typing import TypeAlias

import bpy

from ..unisg_blender.errors import UniSGError, system_reason
from .window_wording import in_window

Steps: TypeAlias = Generator[tuple[float, str], None, None]
"""Work that yields how much is done, 0 to 1, and in words."""
SLICE = 0.05
"""Seconds of work between two redraws: the window stays responsive."""

RELATIVE: set[str] = {"PATH_SUPPORTS_BLEND_RELATIVE"} if bpy.app.version >= (4, 5) else set()
"""Options of paths that may begin with // for the folder of the file, of which Blender 5 warns else."""


def redraw_views(context: bpy.types.Context) -> None:
    """Have all 3D viewports drawn again, their sidebars as well."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


def select_only(context: bpy.types.Context, items: Sequence[bpy.types.Object]) -> None:
    """Select objects and nothing else; the first one is active."""
    for item in context.selected_objects:
        item.select_set(False)
    for item in items:
        item.select_set(True)
    if items:
        context.view_layer.objects.active = items[0]


class Operator(bpy.types.Operator):
    """An operator that does its work in ``run``."""

    @classmethod
    def why_grey(cls, context: bpy.types.Context) -> str:
        """Why the button is grey, "" where it can be pressed."""
        return ""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        reason = cls.why_grey(context)
        if reason:
            cls.poll_message_set(reason)
        return not reason

    def run(self, context: bpy.types.Context) -> set[str] | None:
        """The work; a :class:`UniSGError`, or what the system refuses, is reported. None means that it is finished."""
        raise NotImplementedError

    def execute(self, context: bpy.types.Context) -> set[str]:
        return self.reporting(self.run, context)

    def reporting(self, work: Callable[..., set[str] | None], *about: object) -> set[str]:
        """What some work returns; cancelled, with a report, where the user has to mend something."""
        try:
            return work(*about) or {"FINISHED"}
        except UniSGError as error:
            self.report({"ERROR"}, in_window(str(error)))
        except OSError as error:
            self.report({"ERROR"}, system_reason(error))
        return {"CANCELLED"}


class FileOperator(Operator):
    """An operator that asks for a file first, in the folder of the last one; whether it did so is ``browsed``."""

    filepath: bpy.props.StringProperty(name="File", subtype="FILE_PATH", options={"SKIP_SAVE"})
    browsed = False
    last_folder = ""

    def execute(self, context: bpy.types.Context) -> set[str]:
        type(self).last_folder = os.path.join(os.path.dirname(bpy.path.abspath(self.filepath)), "")
        return super().execute(context)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        self.browsed = True
        self.filepath = self.filepath or type(self).last_folder
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}


class SearchOperator(Operator):
    """An operator that asks first which item of its ``bl_property`` is meant."""

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        context.window_manager.invoke_search_popup(self)
        return {"RUNNING_MODAL"}


class SteppedOperator(Operator):
    """An operator that goes on between redraws until it is done, or Esc stops it; scripts get all of it at once."""

    def steps(self, context: bpy.types.Context) -> Steps:
        """The work."""
        raise NotImplementedError

    def finish(self, context: bpy.types.Context) -> set[str] | None:
        """What is left to do, and to say, when all steps are done."""
        raise NotImplementedError

    def stopped(self, context: bpy.types.Context) -> str:
        """What to say when the user has stopped it."""
        raise NotImplementedError

    def show(self, context: bpy.types.Context, share: float, text: str) -> None:
        """Show how far it is; no text: it has ended."""
        context.window_manager.progress_update(share)
        context.workspace.status_text_set(f"{text}   ESC: stop" if text else None)

    def run(self, context: bpy.types.Context) -> set[str] | None:
        for _ in self.steps(context):
            pass
        return self.finish(context)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        self._work = self.steps(context)
        self._timer = context.window_manager.event_timer_add(0.01, window=context.window)
        context.window_manager.progress_begin(0, 1)
        self.show(context, 0.0, "Starting")
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if event.type == "ESC":
            self._work.close()
            self._end(context)
            self.report({"INFO"}, f"Stopped; {self.stopped(context)}")
            return {"CANCELLED"}
        return self.reporting(self._advance, context) if event.type == "TIMER" else {"RUNNING_MODAL"}

    def _advance(self, context: bpy.types.Context) -> set[str] | None:
        try:
            done = self._slice()
        except Exception:
            self._end(context)
            raise
        if done is None:
            self._end(context)
            return self.finish(context)
        self.show(context, *done)
        return {"RUNNING_MODAL"}

    def _slice(self) -> tuple[float, str] | None:
        """Work for a moment, not for one step only: a redraw may take longer than a step. None at the end."""
        end = time.perf_counter() + SLICE
        while True:
            done = next(self._work, None)
            if done is None or time.perf_counter() >= end:
                return done

    def _end(self, context: bpy.types.Context) -> None:
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        self.show(context, 0.0, "")

"""Sub-panel "Recording": the master file, recording and replay."""

from __future__ import annotations

import bpy

from ..operators.recording import take
from .main import DataPanel


class UNISG_PT_recording(DataPanel):
    """Save the scene as a master file, record motion and what lessons make of it, replay it"""

    bl_label = "Files and Recordings"

    def draw(self, context: bpy.types.Context) -> None:
        column = self.layout.column(align=True)
        column.operator("unisg.convert", icon="EXPORT")
        column.operator("unisg.open_master_file", icon="IMPORT")
        column = self.layout.column(align=True)
        if take() is not None:
            column.alert = True
            column.operator("unisg.record_stop", icon="SNAP_FACE")
            column.label(text="Move things, or play the lesson", icon="REC")
            return
        column.operator_context = "INVOKE_DEFAULT"
        column.operator("unisg.record", icon="REC").playback = False
        column.operator("unisg.record", text="Record Playback", icon="RENDER_ANIMATION").playback = True
        _kept(self.layout, context)
        column = self.layout.column()
        column.operator_context = "INVOKE_DEFAULT"
        column.operator("unisg.replay_file", icon="FILE_FOLDER")


def _kept(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What the scene holds of a recording, to replay or to clear."""
    from ..unisg_blender.blender.motion.scene_recording import scene_recording

    found = scene_recording(context.scene)
    if not found:
        return
    moved = sum(len(each.times) > 0 for each in found.values())
    performed = sum(word == "performed" for each in found.values() for _, word, _ in each.events)
    ends = [float(each.times[-1]) for each in found.values() if len(each.times)]
    ends += [when for each in found.values() for when, _, _ in each.events]
    box = layout.box().column(align=True)
    box.label(text=f"{max(ends):.1f} s: {moved} moved, {performed} actions done", icon="INFO")
    row = box.row(align=True)
    row.operator("unisg.replay", text="Replay", icon="PLAY")
    row.operator("unisg.record_clear", text="", icon="X")


CLASSES = (UNISG_PT_recording,)

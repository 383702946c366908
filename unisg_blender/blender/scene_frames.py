"""The frames of a Blender scene: their rate, their range, and where its objects have keys."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import numpy as np
from numpy.typing import NDArray

from ..runtime.read_report import ReadReport
from ..scene.frame_range import DEFAULT_RATE, FrameRange, is_rate
from ..scene.graph import SceneGraph
from ..scene.motion_frames import frame_range_of
from .fcurves import curves_of

FRAMES = (0, 1048574)
"""The first and the last frame that a scene of Blender may play; before the first there may be keys."""
MOST_FPS = 32767


def frame_rate(scene: bpy.types.Scene) -> float:
    """Frames per second; the usual rate where a damaged file has one that cannot be played."""
    base = scene.render.fps_base
    rate = scene.render.fps / base if base else 0.0
    return rate if is_rate(rate) else DEFAULT_RATE


def read_frame_range(scene: bpy.types.Scene, report: ReadReport) -> FrameRange:
    """The frames of a scene; what a damaged file says of them, and cannot be, is told."""
    rate = frame_rate(scene)
    if not np.isclose(rate * scene.render.fps_base, scene.render.fps):
        report.add("", f"its frame rate cannot be played; read as {rate:g} frames per second")
    said = scene.frame_start, scene.frame_end
    start = float(np.clip(said[0], *FRAMES))
    end = float(np.clip(said[1], start, FRAMES[1]))
    if (start, end) != said:
        report.add("", f"the frames {said[0]} to {said[1]} cannot be played; read as {start:g} to {end:g}")
    now = float(np.clip(scene.frame_current + scene.frame_subframe, -FRAMES[1], FRAMES[1]))
    return FrameRange(now, start, end, rate)


def set_frame_range(graph: SceneGraph, scene: bpy.types.Scene, report: ReadReport) -> None:
    """Give a scene the frames of a scenegraph; what Blender cannot hold of them is told."""
    frames = frame_range_of(graph)
    if frames is None:
        return
    fps = int(np.clip(np.ceil(frames.rate - 1e-6), 1, MOST_FPS))
    scene.render.fps, scene.render.fps_base = fps, fps / frames.rate
    if abs(frame_rate(scene) - frames.rate) > 1e-6 * frames.rate:
        report.add("", f"{frames.rate:g} frames per second become {frame_rate(scene):g}")
    start, end = np.clip([np.floor(frames.start), np.ceil(frames.end)], *FRAMES)
    if (start, end) != (frames.start, frames.end):
        report.add("", f"the frames {frames.start:g} to {frames.end:g} become {start:g} to {end:g}")
    scene.frame_start, scene.frame_end = int(start), int(end)
    now = float(np.clip(frames.frame, -FRAMES[1], FRAMES[1]))
    scene.frame_current, scene.frame_subframe = int(np.floor(now)), now - np.floor(now)


def key_frames(scene: bpy.types.Scene) -> NDArray[np.float64]:
    """Frames (K,), ascending, at which the scene's objects and their data have keys, or strips begin and end."""
    owners = {part for item in scene.objects for part in (item, item.data, getattr(item.data, "shape_keys", None))}
    found = [frames for part in owners if hasattr(part, "animation_data") for frames in _frames_of(part)]
    frames = np.unique(np.concatenate([np.zeros(0), *found]))
    return frames[np.isfinite(frames)]


def cover_keys(scene: bpy.types.Scene) -> None:
    """Let the scene play as long as its objects have keys: importers leave it at Blender's 250 frames."""
    frames = key_frames(scene)
    if len(frames):
        start, end = np.clip([np.floor(frames[0]), np.ceil(frames[-1])], *FRAMES)
        scene.frame_start, scene.frame_end = int(start), int(end)


def _frames_of(part: bpy.types.ID) -> Iterator[NDArray[np.float64]]:
    animation = part.animation_data
    for track in () if animation is None else animation.nla_tracks:
        for strip in () if track.mute else track.strips:
            yield np.array([strip.frame_start, strip.frame_end])
    for curve in curves_of(part) or ():
        keys = np.empty(2 * len(curve.keyframe_points), np.float32)
        curve.keyframe_points.foreach_get("co", keys)
        yield keys[::2].astype(np.float64)

"""The frames that a scene needs, to play all that moves in it."""

from __future__ import annotations

from dataclasses import replace

from .components import ANIMATION, EVENTS, RECORDING
from .frame_range import DEFAULT_RATE, FrameRange, frames_at
from .graph import SceneGraph


def frame_range_of(graph: SceneGraph) -> FrameRange | None:
    """The scene's frames, with all that was recorded in their range.

    Where the scene has none it is one that all motion fits in, at :data:`DEFAULT_RATE`; None where nothing moves.
    """
    frames = graph.frames
    times = _times(graph, ANIMATION, RECORDING) if frames is None else _times(graph, RECORDING)
    if not times:
        return frames
    rate = DEFAULT_RATE if frames is None else frames.rate
    first, last = frames_at([min(times), max(times)], rate)
    if frames is None:
        return FrameRange(first, first, last, rate)
    return replace(frames, start=min(frames.start, first), end=max(frames.end, last))


def _times(graph: SceneGraph, *names: str) -> list[float]:
    """First and last moments of the motion in some components, and of all events, in seconds."""
    clips = [times for name in names for _, times in graph.entries(name, "times") if len(times)]
    ends = [float(moment) for times in clips for moment in (times[0], times[-1])]
    return ends + [float(moment) for _, moment in graph.entries(EVENTS, "time")]

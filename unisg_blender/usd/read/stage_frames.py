"""The time codes of a stage as the scene's frames."""

from __future__ import annotations

import warnings
from typing import Any

from ...errors import UniSGError
from ...scene.frame_range import DEFAULT_RATE, FrameRange, frames_at, is_rate
from ...scene.graph import SceneGraph
from ...scene.motion_frames import frame_range_of


def mend_rates(stage: Any) -> None:
    """Give the layers of a stage a rate where theirs cannot be, which is told; USD would look for samples without end.

    The layers change in memory only.
    """
    for layer in stage.GetUsedLayers():
        rate = layer.timeCodesPerSecond if layer.HasTimeCodesPerSecond() else layer.framesPerSecond
        if not is_rate(rate):
            text = f"{rate:g} time codes per second are no rate; read as {DEFAULT_RATE:g}"
            warnings.warn(f"{layer.GetDisplayName()}: {text}", stacklevel=2)
            layer.timeCodesPerSecond = DEFAULT_RATE


def with_frame_range(graph: SceneGraph, stage: Any, codes: float, frame: Any = None) -> SceneGraph:
    """The scenegraph of a stage with the stage's frames, if it has any or something moves.

    ``codes`` are the stage's time codes per second; ``frame`` is the time code that is shown, the first if omitted.
    """
    shown = float(stage.GetFramesPerSecond()) if stage.HasAuthoredMetadata("framesPerSecond") else codes
    rate = shown if is_rate(shown) else codes
    factor = rate / codes
    if stage.HasAuthoredTimeCodeRange():
        ends = [stage.GetStartTimeCode(), stage.GetEndTimeCode()]
        start, end = ends if factor == 1 else frames_at(ends, factor)
    elif (moving := frame_range_of(graph)) is not None:
        start, end = frames_at([moving.start, moving.end], rate / moving.rate)
    else:
        return graph
    now = frame * factor if isinstance(frame, float) else start
    try:
        return graph.replace(frames=FrameRange(now, start, end, rate))
    except UniSGError as error:
        warnings.warn(f"{error}; the frames of the stage are not read", stacklevel=2)
        return graph

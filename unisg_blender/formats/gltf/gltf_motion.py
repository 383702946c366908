"""How entities move, as an animation of their nodes' translation, rotation and scale."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...geometry.y_up import turned_matrices
from ...runtime.read_report import ReadReport
from ...scene import SceneGraph
from ...scene.components import ANIMATION
from .gltf_axes import parts_of
from .gltf_buffers import Buffers

PATHS = ("translation", "rotation", "scale")


def animations(graph: SceneGraph, buffers: Buffers, report: ReadReport) -> list[dict[str, Any]]:
    """The scene's motion as one animation, [] for none; what glTF cannot move is told."""
    channels: list[dict[str, Any]] = []
    samplers: list[dict[str, Any]] = []
    for row, times, matrices in graph.entries(ANIMATION, "times", "matrices"):
        if not len(times) or not np.isfinite(matrices).all():
            continue
        *parts, straight = parts_of(turned_matrices(np.asarray(matrices, np.float64)))
        if not straight.all():
            report.add(graph.name[row], "it is sheared while it moves: its motion is left out")
            continue
        seconds = np.asarray(times - min(times[0], 0.0), np.float32)
        if (np.diff(seconds) <= 0).any():
            report.add(graph.name[row], "its times do not ascend: its motion is left out")
            continue
        given = buffers.accessor(seconds, bounds=True)
        for path, values in zip(PATHS, parts, strict=True):
            if path == "rotation":
                values = _continuous(values)
            output = buffers.accessor(np.asarray(values, np.float32))
            channels.append({"sampler": len(samplers), "target": {"node": row, "path": path}})
            samplers.append({"input": given, "output": output})
    return [{"name": "Motion", "channels": channels, "samplers": samplers}] if channels else []


def _continuous(turns: Any) -> Any:
    """Quaternions (T, 4) with the signs with which neighbours are nearest."""
    flips = np.where((turns[1:] * turns[:-1]).sum(axis=1) < 0, -1.0, 1.0)
    return turns * np.concatenate([[1.0], np.cumprod(flips)])[:, None]

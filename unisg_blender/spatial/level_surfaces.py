"""Level surfaces on which objects can stand: the upper sides of boxes, and what several of them make together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import Floats, Ints
from ..geometry.boxes import Boxes

LEVEL = 0.01
"""Metres in height within which rectangles make one surface."""

UPRIGHT = 0.985
"""Upward part of the axis of a level surface at least: it is tilted by up to 10 degrees."""

FILLED = 0.75
"""Share of the rectangle around some that they fill at least to be one surface together."""


@dataclass(frozen=True, eq=False)
class LevelSurfaces:
    """Level rectangles: ``center``, direction ``along`` of the first side, ``half`` (S, 2) each, and height ``top``."""

    center: Floats
    along: Floats
    half: Floats
    top: Floats


def rectangles(parts: Boxes) -> LevelSurfaces:
    """The upper sides of boxes that have an axis near the vertical: nothing stays on what is tilted."""
    parts = parts.take(np.flatnonzero(np.abs(parts.axes[:, 2, :]).max(axis=1, initial=0) >= UPRIGHT))
    up = np.abs(parts.axes[:, 2, :]).argmax(axis=1)
    each = np.arange(len(up))
    first, second = (up + 1) % 3, (up + 2) % 3
    along = parts.axes[each, :2, first]
    along = along / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    half = np.stack([parts.half[each, first], parts.half[each, second]], axis=1)
    top = parts.center[:, 2] + np.abs(parts.axes[each, 2, up]) * parts.half[each, up]
    return LevelSurfaces(parts.center[:, :2], along, half, top)


def with_joined(surfaces: LevelSurfaces) -> LevelSurfaces:
    """The same, behind the rectangles around neighbours on one level that fill them: a table top of several pieces."""
    order = np.argsort(surfaces.top, kind="stable")
    groups = np.split(order, np.flatnonzero(np.diff(surfaces.top[order]) > LEVEL) + 1)
    joined = [found for group in groups if len(group) > 1 and (found := _joined(surfaces, group)) is not None]
    if not joined:
        return surfaces
    center, along, half, top = (np.array(column) for column in zip(*joined, strict=True))
    return LevelSurfaces(
        np.concatenate([center, surfaces.center]), np.concatenate([along, surfaces.along]),
        np.concatenate([half, surfaces.half]), np.concatenate([top, surfaces.top]),
    )  # fmt: skip


def _joined(surfaces: LevelSurfaces, group: Ints) -> tuple[Floats, Floats, Floats, float] | None:
    """Centre, direction, half extents and height of the rectangle around a group, None if they do not fill it."""
    half = surfaces.half[group]
    area = half.prod(axis=1)
    lead = int(area.argmax())
    along = surfaces.along[group[lead]]
    across = np.array([-along[1], along[0]])
    offset = surfaces.center[group] - surfaces.center[group[lead]]
    place = np.column_stack([offset @ along, offset @ across])
    cos = np.abs(surfaces.along[group] @ along)[:, None]
    sin = np.abs(surfaces.along[group] @ across)[:, None]
    reach = cos * half + sin * half[:, ::-1]
    low, high = (place - reach).min(axis=0), (place + reach).max(axis=0)
    around = (high - low) / 2
    if area.sum() < FILLED * around.prod():
        return None
    middle = (low + high) / 2
    center = surfaces.center[group[lead]] + middle[0] * along + middle[1] * across
    return center, along, around, float(surfaces.top[group].max())

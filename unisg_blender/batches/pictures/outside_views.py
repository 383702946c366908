"""Looks into a room from outside and above: without its ceiling and the walls in front, or without any wall."""

from __future__ import annotations

import numpy as np

from ...geometry.arrays import Bools, Floats
from ...geometry.camera_view import CameraView, looking
from .surround import ChosenView, Surround

DOLLHOUSE, TURNTABLE = "dollhouse", "turntable"

NARROW = 0.7
"""Angle of view in radians."""

ABOVE = {DOLLHOUSE: 0.95, TURNTABLE: 0.5}
"""By how many radians they look down."""

CUT, MARGIN, OVER = 2.4, 1.05, 1.0
"""Where a house is one mesh: metres over the floor from which on nothing is shown, how much larger than the room the
picture is, and metres over that of the camera."""


def from_outside(
    around: Surround, kind: str, count: int, size: tuple[int, int], rng: np.random.Generator
) -> list[ChosenView]:
    """From outside and above; of a house whose ceiling and floor are one mesh a plan, cut below the ceiling."""
    low, high = around.objects.low.min(axis=0), around.objects.high.max(axis=0)
    if np.isfinite(around.ceiling) or len(around.outline) > 4:
        low[:2], high[:2] = around.outline.min(axis=0), around.outline.max(axis=0)
        low[2], high[2] = around.floor, min(around.ceiling, high[2])
    floor, ceiling = around.are("Floor"), around.are("Ceiling")
    nothing = np.zeros(len(around.graph), bool)
    if (floor & ceiling).any() and np.isfinite(around.ceiling):
        return [ChosenView(_plan(f"{kind} {number}", around, low, high, size), nothing) for number in range(count)]
    middle, radius = (low + high) / 2, float(np.linalg.norm(high - low)) / 2
    back = radius / np.sin(NARROW * min(size) / max(size) / 2)
    found = []
    for number in range(count):
        turn = (number / count if kind == TURNTABLE else 0.125 + number / max(count, 4)) * 2 * np.pi
        way = np.array([np.cos(turn) * np.cos(ABOVE[kind]), np.sin(turn) * np.cos(ABOVE[kind]), np.sin(ABOVE[kind])])
        hidden = around.built & ~floor
        if kind == DOLLHOUSE:
            hidden &= ceiling | _in_front(around, middle, way)
        eye = middle + way * back
        found.append(ChosenView(looking(f"{kind} {number}", eye, middle, size, NARROW, around.clip(back)), hidden))
    return found


def _plan(name: str, around: Surround, low: Floats, high: Floats, size: tuple[int, int]) -> CameraView:
    """Straight down with parallel rays, from where the house is cut."""
    world, wide = np.eye(4), (high - low)[:2] * MARGIN
    top = min(around.ceiling - 0.15, around.floor + CUT)
    world[:3, 3] = [*(low + high)[:2] / 2, top + OVER]
    focal = float(min(size[0] / wide[0], size[1] / wide[1]))
    return CameraView(name, world, size, focal, (size[0] / 2, size[1] / 2), (OVER, around.clip(OVER)[1]), True)


def _in_front(around: Surround, middle: Floats, way: Floats) -> Bools:
    """Which rows (N,) are on the side of the middle from which one looks."""
    found = np.zeros(len(around.graph), bool)
    center = (around.objects.low + around.objects.high) / 2
    toward = (center[:, :2] - middle[:2]) @ way[:2]
    found[around.objects.rows] = toward > 0.1
    owner = around.objects.of_row
    return np.where(owner >= 0, found[around.objects.rows][owner], False)

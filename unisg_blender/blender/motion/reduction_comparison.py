"""Keyframe reduction compared on the same motions at the same error: Blender's own, linear + slerp, motors."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import bpy
import numpy as np

from ...poses import (
    compose,
    convert,
    cubic_sclerp,
    exp,
    linear_slerp,
    pose_errors,
    rebuild,
    rebuild_cubic,
    reduce_keyframes,
    sclerp,
    third_poses,
)
from ..fcurves import Floats, Item, curves_of
from .keyframes import key_count, key_times, read_motors, write_motors
from .motor_keys import Tolerance, reduce_item_keyframes

FRAMES = 240
TIMES = np.arange(1.0, FRAMES + 1)
POSE_NUMBERS, THIRDS_NUMBERS = 8, 14  # per key a time and a pose; per span of cubic motors two more poses
BEZIER_NUMBERS = 6  # per key a point and two handles


def compare_reductions(millimetres: float, degrees: float, seed: int) -> list[dict[str, Any]]:
    """Keys that each way needs for each motion, with the errors it reached.

    Works on an object of its own in the current scene, and removes it again.

    Parameters
    ----------
    millimetres, degrees
        Tolerance for every frame, the same for all.
    seed
        Of the motions that are random.

    Returns
    -------
    list of dict
        ``motion``, ``method``, ``key_frames`` (distinct frames with keys), ``numbers`` (that have to be
        stored), ``millimetres`` and ``degrees`` (largest error over all frames).
    """
    rows = []
    for name, dense in motions(seed).items():
        for method, interpolate in (
            ("linear + slerp", linear_slerp),
            ("motors", sclerp),
            ("cubic motors", cubic_sclerp),
        ):
            keys = reduce_keyframes(TIMES, dense, millimetres, degrees, interpolate=interpolate)[0]
            if interpolate is cubic_sclerp:
                found = rebuild_cubic(TIMES, TIMES[keys], dense[keys], third_poses(TIMES, dense, keys))
            else:
                found = rebuild(TIMES, TIMES[keys], dense[keys], interpolate=interpolate)
            numbers = POSE_NUMBERS * len(keys) + THIRDS_NUMBERS * (len(keys) - 1) * (interpolate is cubic_sclerp)
            counts = {"key_frames": len(keys), "numbers": numbers}
            rows.append({"motion": name, "method": method, **counts, **_errors(found, dense)})
        for method, reduce in (("cubic motors, as Blender curves", _by_motors), ("Blender's decimate", _by_blender)):
            with _recorded(dense) as item:
                reduce(item, dense, millimetres, degrees)
                counts = {"key_frames": len(key_times(item)), "numbers": BEZIER_NUMBERS * key_count(item)}
                rows.append({"motion": name, "method": method, **counts, **_errors(_played(item), dense)})
    return rows


def motions(seed: int) -> dict[str, Floats]:
    """Dense motions, dual quaternions (FRAMES, 8), in metres: of machines, of animators, of hands."""
    rng = np.random.default_rng(seed)
    time = np.linspace(0.0, 1.0, FRAMES)
    eased = time * time * (3.0 - 2.0 * time)
    edge = exp([0.0, 0.0, 0.0, 0.9, 0.0, 0.0])  # the body's origin stands 0.9 m from the hinge
    zero = np.zeros(FRAMES)
    apart = [eased, 0.4 * eased, zero, np.cos(0.75 * eased), zero, zero, np.sin(0.75 * eased)]
    knots = exp(rng.normal(size=(7, 6)) * [1.0, 1.0, 1.0, 0.5, 0.5, 0.5])
    hand = _smoothed(rng.normal(size=(FRAMES, 6)), 20.0) * [4.0, 4.0, 4.0, 2.0, 2.0, 2.0]
    shaking = hand + rng.normal(size=hand.shape) * [1e-3, 1e-3, 1e-3, 5e-4, 5e-4, 5e-4]
    return {
        "door at constant speed": compose(exp(np.outer(time, [0, 0, 1.9, 0, 0, 0])), edge),
        "machine: screws between 7 poses": rebuild(time, np.linspace(0, 1, 7), knots),
        "door, eased": compose(exp(np.outer(eased, [0, 0, 1.9, 0, 0, 0])), edge),
        "line and turn, eased": convert(np.stack(apart, axis=1), "quaternion", "dual_quaternion"),
        "smooth hand": exp(hand),
        "shaking hand": exp(shaking),
    }


def _smoothed(values: Floats, width: float) -> Floats:
    reach = np.arange(-4 * width, 4 * width + 1)
    kernel = np.exp(-0.5 * (reach / width) ** 2)
    padded = np.pad(values, ((len(reach) // 2, len(reach) // 2), (0, 0)), mode="wrap")
    return np.stack([np.convolve(column, kernel / kernel.sum(), mode="valid") for column in padded.T], axis=1)


def _errors(found: Floats, dense: Floats) -> dict[str, float]:
    distance, angle = pose_errors(found, dense)
    return {"millimetres": float(distance.max() * 1e3), "degrees": float(np.degrees(angle.max()))}


def _played(item: Item) -> Floats:
    return read_motors(item, TIMES)


@contextmanager
def _recorded(dense: Floats) -> Iterator[bpy.types.Object]:
    """An object with a key at every frame."""
    item = bpy.data.objects.new("comparison", None)
    bpy.context.scene.collection.objects.link(item)
    item.rotation_mode = "QUATERNION"
    item.keyframe_insert("location", frame=1)
    item.keyframe_insert("rotation_quaternion", frame=1)
    write_motors(item, TIMES, dense)
    action = item.animation_data.action
    try:
        yield item
    finally:
        bpy.data.objects.remove(item)
        bpy.data.actions.remove(action)


def _by_motors(item: Item, dense: Floats, millimetres: float, degrees: float) -> None:
    reduce_item_keyframes(item, Tolerance(millimetres, degrees))


def _by_blender(item: Item, dense: Floats, millimetres: float, degrees: float) -> None:
    """Decimate with the largest margin, found by halving, that keeps the played motion within tolerance."""
    good, bad = 0.0, 0.1
    for _ in range(12):
        margin = 0.5 * (good + bad)
        write_motors(item, TIMES, dense)
        _decimate(item, margin)
        errors = _errors(_played(item), dense)
        fits = errors["millimetres"] <= millimetres and errors["degrees"] <= degrees
        good, bad = (margin, bad) if fits else (good, margin)
    write_motors(item, TIMES, dense)
    _decimate(item, good)


def _decimate(item: Item, margin: float) -> None:
    """The graph editor's "Decimate (Allowed Change)" on all keys of an item."""
    bpy.ops.object.select_all(action="DESELECT")
    item.select_set(True)
    bpy.context.view_layer.objects.active = item
    for curve in curves_of(item):
        curve.select = True
        for point in curve.keyframe_points:
            point.select_control_point = True
    window = bpy.context.window_manager.windows[0]
    area = window.screen.areas[0]
    before, area.type = area.type, "GRAPH_EDITOR"
    try:
        region = next(region for region in area.regions if region.type == "WINDOW")
        with bpy.context.temp_override(window=window, screen=window.screen, area=area, region=region):
            bpy.ops.graph.decimate(mode="ERROR", remove_error_margin=margin)
    finally:
        area.type = before

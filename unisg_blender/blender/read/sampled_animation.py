"""Motion as sampled local matrices."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence

import bpy
import numpy as np
from numpy.typing import NDArray

from ...runtime.read_report import ReadReport
from ...scene.component_table import table
from ...scene.components import ANIMATION
from ...scene.graph import SceneGraph
from ..depsgraph import updated_depsgraph
from ..lookup import objects_by_uid
from ..scene_frames import FRAMES, frame_rate, key_frames
from ..scene_units import metres_per_unit, scale_translations
from .object_hierarchy import read_hierarchy

MOST_FRAMES = 10_000
WHOLE = 1e-3  # a key this near to a whole frame is on it
STILL = 1e-7  # matrices that differ less, relative to their size, have not moved


def may_move(scene: bpy.types.Scene) -> bool:
    """Whether anything in the file could move the scene's objects, so that sampling is worth its time."""
    owners = [*scene.objects, *{item.data for item in scene.objects if item.data is not None}]
    return scene.rigidbody_world is not None or any(getattr(each, "animation_data", None) for each in owners)


def sample_animation(
    graph: SceneGraph,
    scene: bpy.types.Scene | None = None,
    frames: Iterable[float] | None = None,
    progress: Callable[[int, int], None] | None = None,
    report: ReadReport | None = None,
) -> SceneGraph:
    """The scenegraph with the component ``animation``: how its entities move in the scene it was read from.

    Everything that moves objects counts: keyframes, drivers, constraints, physics.
    The scene is stepped through the frames and ends at the frame where it was.

    Parameters
    ----------
    graph
        A scenegraph of ``scene``.
    scene
        The current scene when omitted.
    frames
        Ascending frames; those of :func:`frames_of_motion` when omitted. Times are frame / frame rate.
    progress
        Called with (frames done, frames in all).
    report
        Is told what is too long to be read.
    """
    scene = scene or bpy.context.scene
    frames = frames_of_motion(scene, ReadReport() if report is None else report) if frames is None else list(frames)
    rate = frame_rate(scene)
    rows = {item: graph.row_of_uid[uid] for uid, item in objects_by_uid(scene).items() if uid in graph.row_of_uid}
    before = scene.frame_current, scene.frame_subframe
    try:
        motion = _changes(scene, frames, progress)
    finally:
        scene.frame_set(before[0], subframe=before[1])
    items = list(scene.objects)
    moving = [place for place in motion if items[place] in rows]
    found = table(
        [rows[items[place]] for place in moving],
        times=[np.array(frames, np.float64) / rate] * len(moving),
        matrices=[motion[place] for place in moving],
    )
    return graph.with_component(ANIMATION, found)


def frames_of_motion(scene: bpy.types.Scene, report: ReadReport) -> list[float]:
    """The whole frames of the scene's range and of all keys beyond it, and the keys between whole frames; ascending.

    Of more than :data:`MOST_FRAMES` only every second, third ... is taken, and keys that are too many or too far away
    are left out; both are told.
    """
    keys = key_frames(scene)
    near = keys[np.abs(keys) <= FRAMES[1]]
    start, end = np.clip([scene.frame_start, scene.frame_end], *FRAMES)
    start, end = np.floor(near.min(initial=start)), np.ceil(near.max(initial=end))
    step = max(1, math.ceil((end - start) / MOST_FRAMES))
    taken = near if step > 1 else near[np.abs(near - np.round(near)) > WHOLE]
    if step > 1:
        report.add("", f"all frames of its motion: of {end - start + 1:,.0f} one in {step:,} is read, beside the keys")
    if len(near) < len(keys) or len(taken) > MOST_FRAMES:
        report.add("", f"keys beyond frame {FRAMES[1]}, or more than {MOST_FRAMES:,} of them")
    found: list[float] = np.union1d(np.append(np.arange(start, end, step), end), taken[:MOST_FRAMES]).tolist()
    return found


def _changes(
    scene: bpy.types.Scene, frames: Sequence[float], progress: Callable[[int, int], None] | None
) -> dict[int, NDArray[np.float64]]:
    """Local matrices float64 (T, 4, 4) of the objects, by place in ``scene.objects``, that move at any frame."""
    items = list(scene.objects)
    updated_depsgraph(scene)  # else a scene that was never shown does not follow frame_set
    first = last = np.zeros((0, 4, 4))
    steps: list[tuple[int, NDArray[np.int64], NDArray[np.float64]]] = []
    for number, frame in enumerate(frames):
        whole = math.floor(frame)
        scene.frame_set(whole, subframe=frame - whole)
        local = _evaluated_locals(scene, items)
        if progress is not None:
            progress(number + 1, len(frames))
        if number == 0:
            first = last = local
            continue
        gap, size = np.abs(local - last).max(axis=(1, 2)), np.abs(last).max(axis=(1, 2))
        moved = np.flatnonzero(gap > STILL * size)
        steps.append((number, moved, local[moved]))
        last = last.copy()
        last[moved] = local[moved]
    moving = sorted({int(place) for _, moved, _ in steps for place in moved})
    motion = {place: np.repeat(first[place][None], len(frames), axis=0) for place in moving}
    for number, moved, matrices in steps:  # each change lasts until the next one
        for place, matrix in zip(moved.tolist(), matrices, strict=True):
            motion[place][number:] = matrix
    return motion


def _evaluated_locals(scene: bpy.types.Scene, items: Sequence[bpy.types.Object]) -> NDArray[np.float64]:
    """Local matrices in metres, those of constrained objects from where they and their parents stand."""
    _, depsgraph = updated_depsgraph(scene)
    hierarchy = read_hierarchy(scene.objects, items, depsgraph)
    local = hierarchy.local
    worlds = dict(zip(hierarchy.moved.tolist(), hierarchy.world, strict=True))
    for row, world in worlds.items():
        above = items[row].parent
        frame = np.array(above.evaluated_get(depsgraph).matrix_world, np.float64) if above else np.eye(4)
        if hierarchy.parent[row] < 0 or abs(np.linalg.det(frame)) < 1e-12:
            frame = np.eye(4)
        local[row] = np.linalg.inv(frame) @ world
    return scale_translations(local, metres_per_unit(scene))

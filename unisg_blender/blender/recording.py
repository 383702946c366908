"""Recordings: how objects are moved, from playback or while a user moves them, and back onto the scene."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError
from ..poses import FORMS, convert
from ..poses.motion import PIVOT
from ..poses.reduction import reduce_keyframes
from ..scene.components import ANIMATION, RECORDING
from ..scene.graph import SceneGraph, table
from .animation import STILL, sample_animation, write_animation
from .hierarchy import read_hierarchy, updated_depsgraph
from .lookup import objects_by_uid
from .read import read_scene
from .report import ReadReport


@dataclass
class Recorder:
    """Collects the local matrices of everything that moves; it holds uids and numbers, no Blender objects.

    ``poses`` holds, for every uid that moved, (seconds, local matrix) in order.
    """

    poses: dict[str, list[tuple[float, NDArray[np.float64]]]] = field(default_factory=dict)
    _last: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    _before: float | None = None

    def sample(self, scene: bpy.types.Scene, seconds: float) -> int:
        """Look at the scene now; returns how many objects have moved since the last look."""
        items = list(scene.objects)
        _, depsgraph = updated_depsgraph(scene)
        local = read_hierarchy(scene.objects, items, depsgraph).local
        place = {item: row for row, item in enumerate(items)}
        moved = 0
        for uid, item in objects_by_uid(scene).items():
            pose, last = local[place[item]].copy(), self._last.get(uid)
            if last is not None and np.abs(pose - last).max() > STILL * max(np.abs(last).max(), 1.0):
                clip = self.poses.setdefault(uid, [])
                if self._before is not None and (not clip or clip[-1][0] < self._before):
                    clip.append((self._before, last))  # it stood still until the last look
                clip.append((seconds, pose))
                moved += 1
            self._last[uid] = pose
        self._before = seconds
        return moved

    def recorded(self, graph: SceneGraph, millimetres: float = 0.5, degrees: float = 0.1) -> SceneGraph:
        """The scenegraph with the component ``recording``; keyframes that others imply are left out.

        ``millimetres`` and ``degrees`` say how far any sample may be off; 0 keeps all.
        """
        clips = [(graph.row_of_uid[uid], clip) for uid, clip in self.poses.items() if uid in graph.row_of_uid]
        times = [np.array([moment for moment, _ in clip]) for _, clip in clips]
        matrices = [np.array([pose for _, pose in clip]) for _, clip in clips]
        kept = [needed_keys(*clip, millimetres, degrees) for clip in zip(times, matrices, strict=True)]
        found = table(
            [row for row, _ in clips],
            times=[each[keys] for each, keys in zip(times, kept, strict=True)],
            matrices=[each[keys] for each, keys in zip(matrices, kept, strict=True)],
        )
        return graph.with_component(RECORDING, found)


def needed_keys(
    times: NDArray[np.float64], matrices: NDArray[np.float64], millimetres: float, degrees: float
) -> NDArray[np.integer]:
    """Numbers of the samples (T, 4, 4) to keep as linear keyframes; all where size or shear change, too."""
    form = FORMS["quaternion"]
    everything = np.arange(len(times))
    stretch = form.encode(matrices, stretch=True)[:, form.width :]
    if (
        len(times) < 3
        or millimetres <= 0
        or degrees <= 0
        or np.ptp(stretch, axis=0).max() > 1e-6 * np.abs(stretch).max()
    ):
        return everything
    return reduce_keyframes(
        times, form.encode(matrices), millimetres, degrees, "quaternion", interpolate=as_blender_does
    )[0]


def as_blender_does(a: Any, b: Any, fraction: Any, form: str = PIVOT) -> Any:
    """Between two poses channel by channel, as linear F-curves do it: translation apart, quaternion apart."""
    first, second = convert(a, form, "quaternion"), convert(b, form, "quaternion")
    fraction = np.asarray(fraction, np.float64)
    fraction = fraction.reshape(fraction.shape + (1,) * (first.ndim - fraction.ndim))
    against = (first[..., 3:] * second[..., 3:]).sum(axis=-1, keepdims=True) < 0
    second = np.concatenate([second[..., :3], np.where(against, -1.0, 1.0) * second[..., 3:]], axis=-1)
    between = FORMS["quaternion"].project((1 - fraction) * first + fraction * second)
    return convert(between, "quaternion", form)


def record_playback(scene: bpy.types.Scene | None = None) -> SceneGraph:
    """The scenegraph of a scene with all that moves during its playback as the component ``recording``."""
    scene = scene or bpy.context.scene
    graph = sample_animation(read_scene(scene), scene)
    found = graph.components.get(ANIMATION)
    if found is None:
        return graph
    components = {name: each for name, each in graph.components.items() if name != ANIMATION}
    return graph.replace(components=components | {RECORDING: found})


def replay(graph: SceneGraph, scene: bpy.types.Scene | None = None, report: ReadReport | None = None) -> int:
    """Set the recording of a scenegraph as keyframes of the scene's objects of the same uids.

    Returns
    -------
    int
        How many objects got keyframes; what they were animated with before is taken off them.

    Raises
    ------
    UniSGError
        If there is no recording, or none of its objects is in the scene.
    """
    scene = scene or bpy.context.scene
    found = graph.components.get(RECORDING)
    if found is None:
        raise UniSGError("there is no recording in it")
    by_uid = objects_by_uid(scene)
    objects = {row: by_uid[graph.uid[row]] for row in found.rows.tolist() if graph.uid[row] in by_uid}
    if not objects:
        raise UniSGError("none of the recorded objects is in this scene: did their identities change?")
    for item in objects.values():
        item.animation_data_clear()
    write_animation(graph, objects, scene, ReadReport() if report is None else report, RECORDING)
    rate = scene.render.fps / scene.render.fps_base
    last = max(float(times[-1]) for times in found.columns["times"])
    scene.frame_end = max(scene.frame_end, int(np.ceil(last * rate)))
    return len(objects)

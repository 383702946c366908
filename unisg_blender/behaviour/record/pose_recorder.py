"""Collect how entities are moved, look by look, and keep the few keyframes from which the rest follows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...poses import FORMS, convert
from ...poses.motion import PIVOT
from ...poses.reduction import reduce_keyframes
from ...scene.component_table import entry_table
from ...scene.components import RECORDING
from ...scene.graph import SceneGraph

STILL = 1e-7
"""Matrices that differ less, relative to their size, have not moved."""


class PoseRecorder:
    """Collects the local matrices of everything that moves, by uid.

    ``poses`` holds, for every uid that moved, (seconds, local matrix) in order.
    """

    def __init__(self) -> None:
        self.poses: dict[str, list[tuple[float, NDArray[np.float64]]]] = {}
        self._uids: tuple[str, ...] = ()
        self._last: NDArray[np.float64] = np.zeros((0, 4, 4))
        self._before = 0.0

    def look(self, uids: Sequence[str], local: NDArray[np.float64], seconds: float) -> int:
        """Take down the local matrices (N, 4, 4) at a time; returns how many entities moved since the last look."""
        if self._uids != tuple(uids):  # something came or went: what stays is compared with where it was
            known = dict(zip(self._uids, self._last, strict=True))
            self._last = np.array([known.get(uid, pose) for uid, pose in zip(uids, local, strict=True)])
            self._last = self._last.reshape(-1, 4, 4)
            self._uids = tuple(uids)
        gap, size = np.abs(local - self._last).max(axis=(1, 2)), np.abs(self._last).max(axis=(1, 2))
        moved = gap > STILL * np.maximum(size, 1.0)
        for row in np.flatnonzero(moved):
            clip = self.poses.setdefault(uids[row], [])
            if not clip or clip[-1][0] < self._before:
                clip.append((self._before, self._last[row]))  # it stood still until the last look
            clip.append((seconds, local[row].copy()))
        self._last = np.where(moved[:, None, None], local, self._last)
        self._before = seconds
        return int(moved.sum())

    def recorded(self, graph: SceneGraph, millimetres: float = 0.5, degrees: float = 0.1) -> SceneGraph:
        """The scenegraph with the component ``recording``; keyframes that others imply are left out.

        ``millimetres`` and ``degrees`` say how far any sample may be off; 0 keeps all.
        """
        entries = []
        for uid, clip in self.poses.items():
            if uid in graph.row_of_uid:
                times, matrices = np.array([moment for moment, _ in clip]), np.array([pose for _, pose in clip])
                kept = needed_keys(times, matrices, millimetres, degrees)
                entries.append((graph.row_of_uid[uid], times[kept], matrices[kept]))
        return graph.with_component(RECORDING, entry_table(entries, "times", "matrices"))


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

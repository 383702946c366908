"""Motion of entities over time, and what a user does meanwhile: the script of a simulation."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...errors import UniSGError
from ...poses import FORMS
from ...poses.reduction import rebuild
from ...scene.graph import SceneGraph
from ...scene.hierarchy import without_world, world_matrices
from ..fulfilment.snapshot import Moment, moment

PARENT = "parent"
WORLD = ""
FORM = "dual_quaternion"


@dataclass(frozen=True, eq=False)
class Track:
    """How one entity moves.

    ``times`` float64 (T,) ascending seconds, ``matrices`` float64 (T, 4, 4) its poses
    then, in the frame ``frame``: :data:`PARENT`, :data:`WORLD`, or the uid of an entity.
    """

    uid: str
    times: NDArray[np.float64]
    matrices: NDArray[np.float64]
    frame: str = PARENT

    def at(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Poses (F, 4, 4) at any times: rotation and place along screws, scale linearly; held outside."""
        if len(self.times) == 1:
            return np.repeat(self.matrices, len(times), axis=0)
        form = FORMS[FORM]
        keys = form.encode(self.matrices, stretch=True)
        poses = rebuild(times, self.times, keys[:, : form.width], FORM)
        stretch = [np.interp(times, self.times, channel) for channel in keys[:, form.width :].T]
        return form.decode(np.column_stack([poses, *stretch]), stretch=True)


@dataclass(frozen=True)
class Input:
    """Something a user does at a time (seconds).

    ``uid`` is that of a tool, whose ``trigger`` is pressed or released or which is
    used with a ``force`` in newtons from now on, or that of a Question, which gets
    an ``answer`` (positions chosen). None: no change.
    """

    time: float
    uid: str
    trigger: bool | None = None
    force: float | None = None
    answer: tuple[int, ...] | None = None


@dataclass(frozen=True, eq=False)
class Motion:
    """Tracks and inputs; ``rate`` in frames per second."""

    tracks: tuple[Track, ...] = ()
    inputs: tuple[Input, ...] = ()
    rate: float = 30.0

    @property
    def span(self) -> tuple[float, float]:
        """First and last time of anything that happens, in seconds."""
        times = [float(time) for track in self.tracks for time in track.times[[0, -1]]]
        times += [each.time for each in self.inputs]
        return (min(times), max(times)) if times else (0.0, 0.0)


def moments(graph: SceneGraph, motion: Motion, rest: float = 0.5) -> Iterator[Moment]:
    """The motion's moments one by one, at its rate, and ``rest`` seconds more after its end.

    Raises
    ------
    UniSGError
        If tracks move entities in frames that move with them, in a circle.
    """
    first, last = motion.span
    times = first + np.arange(int(np.ceil((last + rest - first) * motion.rate - 1e-6)) + 1) / motion.rate
    stage, rows = _stage(graph, motion)
    poses = [track.at(times) for track in motion.tracks if track.uid in graph.row_of_uid]
    inputs = sorted(motion.inputs, key=lambda each: each.time)
    trigger: dict[str, bool] = {}
    force: dict[str, float] = {}
    for frame, time in enumerate(times):
        answers: dict[str, tuple[int, ...]] = {}
        while inputs and inputs[0].time <= time + 1e-9:
            _take(inputs.pop(0), trigger, force, answers)
        local = stage.local.copy()
        local[rows] = [track[frame] for track in poses] if rows else local[rows]
        pressed = [uid for uid, down in trigger.items() if down]
        yield moment(graph, time, world_matrices(stage.replace(local=local)), pressed, force, answers)


def _take(new: Input, trigger: dict[str, bool], force: dict[str, float], answers: dict[str, tuple[int, ...]]) -> None:
    if new.trigger is not None:
        trigger[new.uid] = new.trigger
    if new.force is not None:
        force[new.uid] = new.force
    if new.answer is not None:
        answers[new.uid] = new.answer


def _stage(graph: SceneGraph, motion: Motion) -> tuple[SceneGraph, list[int]]:
    """The scene with the moving entities hung where their tracks say, and their rows."""
    row_of: Mapping[str, int] = graph.row_of_uid
    parent, rows = graph.parent.copy(), []
    for track in motion.tracks:
        if track.uid not in row_of:
            continue
        rows.append(row_of[track.uid])
        if track.frame != PARENT:
            if track.frame and track.frame not in row_of:
                raise UniSGError(
                    f"{graph.name[rows[-1]]!r} moves in the frame {track.frame!r}, which is not in the scene"
                )
            parent[rows[-1]] = row_of[track.frame] if track.frame else -1
    return without_world(graph, rows).replace(parent=parent), rows

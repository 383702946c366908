"""A hand that moves objects, presses triggers and answers while a lesson is played along."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...scene import components
from ...scene.hierarchy import placed, world_matrices
from ..fulfilment.snapshot import moment
from ..playing.player import Lesson, PlayState, begin, play
from ..record.motion_tracks import PARENT, Input, Motion, Track

MOVE = 1.0
"""Seconds that a hand takes from one place to another."""


class Hand:
    """Acts frame by frame at ``rate`` frames per second and writes down what it does.

    ``state`` is how far the lesson has come; :meth:`motion` what was done so far.
    """

    def __init__(self, lesson: Lesson, rate: float) -> None:
        self.lesson, self.rate = lesson, rate
        self.state: PlayState = begin(lesson)
        self._stage, self._local = lesson.graph, lesson.graph.local.copy()
        self._frame = -1
        self._keys: dict[int, list[tuple[float, NDArray[np.float64]]]] = {}
        self._inputs: list[Input] = []
        self._pressed: set[str] = set()
        self._force: dict[str, float] = {}

    @property
    def world(self) -> NDArray[np.float64]:
        """World matrices (N, 4, 4) of all entities now; the caller's own, to be changed into goals."""
        return world_matrices(self._stage.replace(local=self._local)).copy()

    def motion(self) -> Motion:
        """Everything done so far."""
        tracks = [
            Track(
                self.lesson.graph.uid[row], np.array([time for time, _ in keys]), np.array([pose for _, pose in keys])
            )
            for row, keys in self._keys.items()
        ]
        return Motion(tuple(tracks), tuple(self._inputs), self.rate)

    def wait(self, seconds: float) -> None:
        """Do nothing for so long, at least one frame."""
        for _ in range(max(1, int(np.ceil(seconds * self.rate - 1e-9)))):
            self._advance({})

    def move(self, row: int, goal: NDArray[np.float64]) -> None:
        """Bring an entity to a world matrix (4, 4) within :data:`MOVE` seconds; what hangs on it comes along."""
        self._take_in_hand(row)
        above, start = self.lesson.graph.parent[row], self._frame / self.rate
        target = np.linalg.solve(self.world[above], goal) if above >= 0 else goal.copy()
        frames = max(1, int(np.ceil(MOVE * self.rate)))
        stop = (self._frame + frames) / self.rate
        keys = self._keys.setdefault(row, [])
        if not keys or keys[-1][0] < start:
            keys.append((start, self._local[row].copy()))
        track = Track("", np.array([start, stop]), np.array([self._local[row], target]), PARENT)
        for pose in track.at((self._frame + np.arange(1, frames + 1)) / self.rate):
            self._local[row] = pose
            self._advance({})
        keys.append((stop, target))

    def press(self, uid: str, down: bool, force: float) -> None:
        """Press or release the trigger of a tool and use it with a force, from the next frame on."""
        (self._pressed.add if down else self._pressed.discard)(uid)
        self._force[uid] = force
        self._inputs.append(Input((self._frame + 1) / self.rate, uid, trigger=down, force=force))

    def answer(self, uid: str, chosen: tuple[int, ...]) -> None:
        """Answer a question."""
        self._inputs.append(Input((self._frame + 1) / self.rate, uid, answer=chosen))
        self._advance({uid: chosen})

    def _advance(self, answers: dict[str, tuple[int, ...]]) -> None:
        self._frame += 1
        now = moment(self.lesson.graph, self._frame / self.rate, self.world, self._pressed, self._force, answers)
        self.state, _ = play(self.lesson, self.state, now)

    def _take_in_hand(self, row: int) -> None:
        """What a constraint held in place follows the hand from now on, starting where it is."""
        if self._stage.entries(components.WORLD, row=row):
            self._stage = placed(self._stage.replace(local=self._local), [row], self.world[[row]])
            self._local = self._stage.local.copy()

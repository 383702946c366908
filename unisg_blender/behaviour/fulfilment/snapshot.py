"""One moment of a simulation: where everything is, and what the user does."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...scene.graph import SceneGraph


@dataclass(frozen=True, eq=False)
class Moment:
    """What the conditions of actions look at.

    Attributes
    ----------
    time
        Seconds since the start.
    world
        float64 (N, 4, 4): world matrices of all entities, column vectors, metres.
    trigger
        bool (N,): the entity's trigger is pressed.
    force
        float64 (N,): the force in newtons with which the entity is used.
    answers
        Answers given in this moment: positions chosen, by uid of the Question.
    """

    time: float
    world: NDArray[np.float64]
    trigger: NDArray[np.bool_]
    force: NDArray[np.float64]
    answers: Mapping[str, tuple[int, ...]]


def moment(
    graph: SceneGraph,
    time: float,
    world: NDArray[np.float64],
    trigger: Collection[str] = (),
    force: Mapping[str, float] | None = None,
    answers: Mapping[str, tuple[int, ...]] | None = None,
) -> Moment:
    """A moment from inputs by uid; what is not mentioned is not pressed, used without force, not answered.

    ``world`` (N, 4, 4) are the world matrices, metres; uids that are not in the scene are passed over.
    """
    row_of = graph.row_of_uid
    pressed = np.zeros(len(graph), bool)
    pressed[[row_of[uid] for uid in trigger if uid in row_of]] = True
    forces = np.zeros(len(graph))
    for uid, newtons in (force or {}).items():
        if uid in row_of:
            forces[row_of[uid]] = newtons
    return Moment(float(time), world, pressed, forces, dict(answers or {}))

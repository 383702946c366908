"""What a room lacks: what the training rooms that are most like it have more of, and how many of them do."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...errors import UniSGError
from ...scene.categories import STRUCTURE
from .contract import Contract
from .scene_reading import SceneReading, why_foreign

LIKE, LEAST = 32, 0.05
"""How many training rooms are looked at, those with most in common, and the share of them from which on it is told."""


HALF = 0.5
"""Share of a room's things that the model knows, from which on a room of another kind is told something all the same:
half a living room looks like a dining room."""


@dataclass(frozen=True)
class Suggestion:
    """Another thing of a ``category`` that a room may lack: the ``share`` of the rooms like it that have more of them
    than its ``count``."""

    category: str
    share: float
    count: int


def suggestions(reading: SceneReading, contract: Contract) -> tuple[Suggestion, ...]:
    """What is missing in a scene, the likeliest first; never what is building where there is a room already.

    Raises
    ------
    UniSGError
        If the scene is foreign to the model, and most of its things are unknown.
    """
    if reading.is_foreign and reading.known < HALF * len(reading.things):
        raise UniSGError(why_foreign(reading))
    rooms, here = np.array(contract.priors.rooms), _counts(reading, contract)
    things = np.array([name not in STRUCTURE for name in contract.vocabulary])
    common = np.minimum(rooms, here)[:, things].sum(axis=1)
    either = np.maximum(rooms, here)[:, things].sum(axis=1)
    likest = np.argsort(-common / np.maximum(either, 1), kind="stable")[:LIKE]
    share = (rooms[likest] > here).mean(axis=0)
    wanted = [number for number in np.argsort(-share, kind="stable").tolist() if share[number] >= LEAST]
    return tuple(
        Suggestion(contract.vocabulary[number], float(share[number]), int(here[number]))
        for number in wanted
        if things[number] or not reading.has_room
    )


def _counts(reading: SceneReading, contract: Contract) -> np.ndarray:
    """How many of each of a model's categories the room in use has, (C,)."""
    return np.array([reading.present.count(name) for name in contract.vocabulary])

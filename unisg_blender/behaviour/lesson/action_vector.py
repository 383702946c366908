"""An action as a fixed vector with a mask, for networks, and back.

The numeric fields get through unharmed (in float64, bit by bit); what is no
number (uids, names, answer texts) stays outside: the entities and actions that
an action refers to are edges, see :mod:`.behaviour_links`. docs/behaviour.md lists the channels.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from ...scene.action_data import TYPES, ActionData, Thresholds
from ...scene.graph import SceneGraph
from .action_places import ActionPlace, action_places, all_actions

ANSWER_SLOTS = 8

_LIMITS = tuple(item.name for item in fields(Thresholds))
_COUNTS = ("targets", "tools", "members", "answers")
_PLACE = tuple(item.name for item in fields(ActionPlace))

CHANNELS = (
    *(f"type.{name}" for name in (*TYPES, "own")),
    *(f"threshold.{name}" for name in _LIMITS),
    *(f"reference.{row}{column}" for row in range(3) for column in range(4)),
    "reference.in_frame",
    "trigger",
    "any",
    *(f"count.{name}" for name in _COUNTS),
    *(f"correct.{index}" for index in range(ANSWER_SLOTS)),
    *(f"place.{name}" for name in _PLACE),
)
"""Names of the vector's channels, in order."""

WIDTH = len(CHANNELS)
"""Number of channels."""

_FIRST = {name: CHANNELS.index(name) for name in CHANNELS}
TYPE = slice(0, len(TYPES) + 1)
THRESHOLDS = slice(TYPE.stop, TYPE.stop + len(_LIMITS))
REFERENCE = slice(THRESHOLDS.stop, THRESHOLDS.stop + 12)
COUNTS = slice(_FIRST["count.targets"], _FIRST["count.targets"] + len(_COUNTS))
CORRECT = slice(_FIRST["correct.0"], _FIRST["correct.0"] + ANSWER_SLOTS)
PLACE = slice(_FIRST[f"place.{_PLACE[0]}"], WIDTH)


@dataclass(frozen=True, eq=False)
class ActionVectors:
    """Actions as rows of numbers.

    ``values`` float64 (A, :data:`WIDTH`), 0 where ``mask`` bool (A, WIDTH) is
    False; ``actions`` the A actions; ``owner`` int64 (A,): the entities (rows of
    the graph) that they belong to.
    """

    values: NDArray[np.float64]
    mask: NDArray[np.bool_]
    actions: tuple[ActionData, ...]
    owner: NDArray[np.int64]


def action_vector(graph: SceneGraph) -> ActionVectors:
    """All actions of a scene as fixed vectors, their places in the lesson filled in.

    Units: metres, radians, seconds, newtons. The rows are those of the graph's
    ``actions`` table. Of a Question with more than 8 answers the right ones beyond
    the eighth do not fit.
    """
    actions, places = all_actions(graph), action_places(graph)
    values = np.zeros((len(actions), WIDTH))
    mask = np.zeros((len(actions), WIDTH), bool)
    for index, action in enumerate(actions):
        encode_action(action, places.get(action.uid), values[index], mask[index])
    owner = np.array([row for (row,) in graph.entries("actions")], np.int64)
    return ActionVectors(values, mask, actions, owner)


def encode_action(
    action: ActionData, place: ActionPlace | None, values: NDArray[np.float64], mask: NDArray[np.bool_]
) -> None:
    """Write one action into a row of ``values`` and ``mask``, both (:data:`WIDTH`,) and zero."""

    def put(channel: str | slice, numbers: object, used: object = True) -> None:
        """Write numbers into a channel and mark it as used."""
        where = _FIRST[channel] if isinstance(channel, str) else channel
        values[where], mask[where] = numbers, used

    put(TYPE, [action.type == name for name in TYPES] + [action.type not in TYPES])
    limits = [getattr(action.thresholds, name) for name in _LIMITS]
    put(THRESHOLDS, [limit or 0 for limit in limits], [limit is not None for limit in limits])
    if action.reference is not None:
        put(REFERENCE, action.reference[:12])
        put("reference.in_frame", bool(action.frame))
    put("trigger", action.trigger)
    put("any", action.mode == "any", action.mode == "any" or action.type == "Parallel")
    put(COUNTS, [len(getattr(action, name)) for name in _COUNTS])
    slots = range(ANSWER_SLOTS)
    put(CORRECT, [slot in action.correct for slot in slots], [slot < len(action.answers) for slot in slots])
    if place is not None:
        put(PLACE, [getattr(place, name) for name in _PLACE])


def decode_action(values: NDArray[np.floating], mask: NDArray[np.bool_], base: ActionData) -> ActionData:
    """The action with the numeric fields of a vector; everything else is as in ``base``.

    Takes a network's output as well: the type is the largest of its channels (a
    type of the user's own keeps the name in ``base``), limits are cut at 0, hit
    counts are rounded, flags are set from 0.5 on.

    Parameters
    ----------
    values, mask
        One row, each (:data:`WIDTH`,).
    base
        An action with the uid, the name, the entities and the answers.
    """
    kind = (*TYPES, base.type)[int(np.argmax(values[TYPE]))]
    limits: dict[str, float | int] = {}
    for name, value, used in zip(_LIMITS, values[THRESHOLDS], mask[THRESHOLDS], strict=True):
        if used:
            limits[name] = max(0, round(float(value))) if name == "hits" else max(0.0, float(value))
    reference = None
    if mask[REFERENCE].all():
        reference = (*(float(number) for number in values[REFERENCE]), 0.0, 0.0, 0.0, 1.0)
    return replace(
        base,
        type=kind,
        thresholds=Thresholds(**limits),  # type: ignore[arg-type]
        reference=reference,
        trigger=bool(values[_FIRST["trigger"]] > 0.5),
        mode="any" if values[_FIRST["any"]] > 0.5 else "all",
        correct=tuple(int(slot) for slot in np.flatnonzero((values[CORRECT] > 0.5) & mask[CORRECT])),
    )

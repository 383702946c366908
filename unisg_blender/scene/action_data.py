"""ActionData: one structure for every kind of action, and its JSON form."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError
from ..runtime.json_records import check_version, from_record, parse_json, to_record

VERSION = 1
TYPES = ("Insert", "Remove", "Use", "Tool", "Question", "Parallel")
MODES = ("all", "any")


@dataclass(frozen=True)
class Thresholds:
    """When an action counts as performed.

    ``distance`` in metres, ``angle`` in radians, ``hold`` in seconds that the
    condition must last, ``hits`` a number of contacts, ``force`` in newtons.
    None: this action does not ask for it.
    """

    distance: float | None = None
    angle: float | None = None
    hold: float | None = None
    hits: int | None = None
    force: float | None = None


@dataclass(frozen=True)
class ActionData:
    """What has to happen to which entities for an action to be performed.

    Attributes
    ----------
    uid
        Unique identifier, by which the lesson refers to the action.
    type
        One of :data:`TYPES`, or a user's own; :mod:`~..behaviour.fulfilment.conditions` says what each asks for.
    name
        What a learner reads.
    targets, tools
        Uids of the entities that the action is about and that are used in it.
    reference
        Reference pose of the target (of the tool in a Tool action), 16 numbers row-major
        (affine 4x4, column vectors, metres), in the frame of the entity ``frame``; None if there is none.
    frame
        Uid of the entity in whose frame ``reference`` is given; "" for the world.
    thresholds
        When the action counts as performed.
    trigger
        True if a Use needs the tool's trigger as well as contact.
    answers, correct
        Choices of a Question and the positions of the right ones.
    members, mode
        Uids of the actions of a Parallel group, and whether "all" or "any" must be done.
    names
        What the entities and members were called by uid when the action was written: for
        messages about those that are missing, never to look anything up.
    extra
        Fields that this version does not know, kept as they are.
    """

    uid: str
    type: str
    name: str = ""
    targets: tuple[str, ...] = ()
    tools: tuple[str, ...] = ()
    reference: tuple[float, ...] | None = None
    frame: str = ""
    thresholds: Thresholds = Thresholds()
    trigger: bool = False
    answers: tuple[str, ...] = ()
    correct: tuple[int, ...] = ()
    members: tuple[str, ...] = ()
    mode: str = "all"
    names: Mapping[str, str] = field(default_factory=dict)
    extra: Mapping[str, Any] = field(default_factory=dict)

    @property
    def reference_matrix(self) -> NDArray[np.float64] | None:
        """The reference pose as float64 (4, 4)."""
        return None if self.reference is None else np.array(self.reference).reshape(4, 4)


def actions_to_json(actions: Sequence[ActionData]) -> str:
    """The value of the custom property ``unisg_actions``: a JSON list, defaults left out."""
    records = [to_record(action) | {"version": VERSION} for action in actions]
    return json.dumps(records, ensure_ascii=False, sort_keys=True)


def actions_from_json(text: str) -> tuple[ActionData, ...]:
    """Actions from the value of the custom property ``unisg_actions``.

    Raises
    ------
    UniSGError
        If the text is no JSON list of actions, or was written by a newer version.
    """
    records = parse_json(text, "unisg_actions")
    if not isinstance(records, list):
        raise UniSGError("unisg_actions must be a JSON list of actions")
    return tuple(map(_action, records))


def _action(record: Any) -> ActionData:
    if isinstance(record, dict):
        record = dict(record)
        check_version(record.pop("version", VERSION), f"action {record.get('uid')!r} has", VERSION)
    action = from_record(ActionData, record, "action")
    where, reference = f"action {action.uid!r}", action.reference
    if action.mode not in MODES:
        raise UniSGError(f"{where}: 'mode' must be 'all' or 'any'")
    if reference is not None:
        if len(reference) != 16:
            raise UniSGError(f"{where}: 'reference' must be 16 finite numbers, a 4x4 matrix row by row")
        if reference[12:] != (0, 0, 0, 1):
            raise UniSGError(f"{where}: the last row of 'reference' must be 0 0 0 1")
        reference = tuple(map(float, reference))
    for name, limit in vars(action.thresholds).items():
        if limit is not None and limit < 0:
            raise UniSGError(f"{where}: threshold {name!r} must be a number that is not negative")
    return replace(action, reference=reference)

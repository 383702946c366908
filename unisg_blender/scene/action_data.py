"""ActionData: one structure for every kind of action, and its JSON form."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError

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
        One of :data:`TYPES`, or a user's own; :mod:`~..behaviour.play.conditions` says what each asks for.
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


_OPTIONAL = tuple(item.name for item in fields(ActionData) if item.name not in ("uid", "type", "thresholds", "extra"))


def actions_to_json(actions: Sequence[ActionData]) -> str:
    """The value of the custom property ``unisg_actions``: a JSON list, defaults left out."""
    return json.dumps([_to_record(action) for action in actions], ensure_ascii=False, sort_keys=True)


def actions_from_json(text: str) -> tuple[ActionData, ...]:
    """Actions from the value of the custom property ``unisg_actions``.

    Raises
    ------
    UniSGError
        If the text is no JSON list of actions, or was written by a newer version.
    """
    try:
        records = json.loads(text)
    except ValueError as error:
        raise UniSGError(f"unisg_actions is not valid JSON: {error}") from None
    if not isinstance(records, list):
        raise UniSGError("unisg_actions must be a JSON list of actions")
    return tuple(_from_record(record) for record in records)


def _to_record(action: ActionData) -> dict[str, Any]:
    record: dict[str, Any] = dict(action.extra) | {"version": VERSION, "uid": action.uid, "type": action.type}
    blank = ActionData("", "")
    for name in _OPTIONAL:
        value = getattr(action, name)
        if value != getattr(blank, name):
            record[name] = _plain(value)
    limits = {item.name: getattr(action.thresholds, item.name) for item in fields(Thresholds)}
    limits = {name: value for name, value in limits.items() if value is not None}
    return record | ({"thresholds": limits} if limits else {})


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return dict(value)
    return list(value) if isinstance(value, tuple) else value


def _from_record(record: Any) -> ActionData:
    if (
        not isinstance(record, dict)
        or not isinstance(record.get("uid"), str)
        or not isinstance(record.get("type"), str)
    ):
        raise UniSGError("an action needs at least the strings 'uid' and 'type'")
    record = dict(record)
    version = record.pop("version", VERSION)
    if not isinstance(version, int) or version > VERSION:
        raise UniSGError(
            f"action {record['uid']!r} has version {version}; this software reads up to {VERSION}: update it"
        )
    known = {item.name for item in fields(ActionData)} - {"extra"}
    values = {name: record.pop(name) for name in list(record) if name in known}
    values["thresholds"] = _thresholds(values.get("thresholds", {}), values["uid"])
    for name in ("targets", "tools", "answers", "members", "correct"):
        values[name] = _tuple_of(values.get(name, ()), int if name == "correct" else str, name, values["uid"])
    for name, kind in (("name", str), ("frame", str), ("mode", str), ("trigger", bool)):
        if name in values and not isinstance(values[name], kind):
            raise UniSGError(f"action {values['uid']!r}: {name!r} must be a {kind.__name__}")
    if values.get("mode", "all") not in MODES:
        raise UniSGError(f"action {values['uid']!r}: 'mode' must be 'all' or 'any'")
    values["reference"] = _reference(values.get("reference"), values["uid"])
    values["names"] = _names(values.get("names", {}), values["uid"])
    return ActionData(**values, extra=record)


def _tuple_of(value: Any, kind: type, name: str, uid: str) -> tuple[Any, ...]:
    if not isinstance(value, list | tuple) or not all(
        isinstance(item, kind) and not isinstance(item, bool) for item in value
    ):
        raise UniSGError(f"action {uid!r}: {name!r} must be a list of {kind.__name__} values")
    return tuple(value)


def _reference(value: Any, uid: str) -> tuple[float, ...] | None:
    if value is None:
        return None
    numbers = value if isinstance(value, list | tuple) else ()
    if len(numbers) != 16 or not all(isinstance(item, int | float) and math.isfinite(item) for item in numbers):
        raise UniSGError(f"action {uid!r}: 'reference' must be 16 finite numbers, a 4x4 matrix row by row")
    if tuple(numbers[12:]) != (0, 0, 0, 1):
        raise UniSGError(f"action {uid!r}: the last row of 'reference' must be 0 0 0 1")
    return tuple(float(item) for item in numbers)


def _names(value: Any, uid: str) -> dict[str, str]:
    if not isinstance(value, dict) or not all(isinstance(name, str) for name in value.values()):
        raise UniSGError(f"action {uid!r}: 'names' must map uids to names")
    return value


def _thresholds(value: Any, uid: str) -> Thresholds:
    names = {item.name for item in fields(Thresholds)}
    if not isinstance(value, dict) or not set(value) <= names:
        raise UniSGError(f"action {uid!r}: 'thresholds' may have {', '.join(sorted(names))}")
    for name, number in value.items():
        if not isinstance(number, int | float) or isinstance(number, bool) or not 0 <= number < math.inf:
            raise UniSGError(f"action {uid!r}: threshold {name!r} must be a number that is not negative")
    return Thresholds(**value)

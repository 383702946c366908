"""The Lesson-Stage-Action tree (LSA): in which order actions are to be performed."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields
from typing import Any

from ..errors import UniSGError

VERSION = 1
KINDS = ("operation", "lesson", "stage", "action")
MAY_HOLD = {"operation": ("lesson",), "lesson": ("lesson", "stage"), "stage": ("action",), "action": ()}


@dataclass(frozen=True)
class LessonNode:
    """A node of the LSA: Operation > Lesson (may nest) > Stage > Action.

    Attributes
    ----------
    kind
        One of :data:`KINDS`; only actions, the leaves, execute.
    uid, name
        Identifier, and what a learner reads.
    action
        Uid of the :class:`~.action_data.ActionData` that a leaf performs.
    children
        The nodes below, in order.
    requires
        Uids of the nodes of this tree that must be done before.
    optional
        True if the lesson can be finished without it.
    ordered
        True if the children must be done one after another; False for any order.
    extra
        Fields that this version does not know, kept as they are.
    """

    kind: str
    uid: str
    name: str = ""
    action: str = ""
    children: tuple[LessonNode, ...] = ()
    requires: tuple[str, ...] = ()
    optional: bool = False
    ordered: bool = True
    extra: Mapping[str, Any] = field(default_factory=dict)

    def walk(self) -> Iterator[LessonNode]:
        """This node and all below it, depth first."""
        yield self
        for child in self.children:
            yield from child.walk()


def lesson_to_json(operation: LessonNode) -> str:
    """The value of the custom property ``unisg_lsa``: a JSON object, defaults left out."""
    return json.dumps({"version": VERSION} | _to_record(operation), ensure_ascii=False, sort_keys=True)


def lesson_from_json(text: str) -> LessonNode:
    """An operation from the value of the custom property ``unisg_lsa``.

    Raises
    ------
    UniSGError
        If the text is no JSON object of that form, or was written by a newer version.
    """
    try:
        record = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise UniSGError(f"unisg_lsa is not valid JSON: {error}") from None
    if not isinstance(record, dict) or record.get("kind") != "operation":
        raise UniSGError("unisg_lsa must be a JSON object whose kind is 'operation'")
    version = record.pop("version", VERSION)
    if not isinstance(version, int) or version > VERSION:
        raise UniSGError(f"this lesson has version {version}; this software reads up to {VERSION}: update it")
    return _from_record(record)


def _to_record(node: LessonNode) -> dict[str, Any]:
    record: dict[str, Any] = dict(node.extra) | {"kind": node.kind, "uid": node.uid}
    blank = LessonNode("", "")
    for name in ("name", "action", "requires", "optional", "ordered"):
        value = getattr(node, name)
        if value != getattr(blank, name):
            record[name] = list(value) if isinstance(value, tuple) else value
    return record | ({"children": [_to_record(child) for child in node.children]} if node.children else {})


def _from_record(record: Any) -> LessonNode:
    if not isinstance(record, dict) or record.get("kind") not in KINDS or not isinstance(record.get("uid"), str):
        raise UniSGError(f"a node of the lesson needs a 'uid' and a 'kind' out of {', '.join(KINDS)}")
    record = dict(record)
    known = {item.name for item in fields(LessonNode)} - {"extra"}
    values = {name: record.pop(name) for name in list(record) if name in known}
    for name, kind in (("name", str), ("action", str), ("optional", bool), ("ordered", bool)):
        if name in values and not isinstance(values[name], kind):
            raise UniSGError(f"lesson node {values['uid']!r}: {name!r} must be a {kind.__name__}")
    for name in ("children", "requires"):
        if not isinstance(values.get(name, []), list):
            raise UniSGError(f"lesson node {values['uid']!r}: {name!r} must be a list")
    values["children"] = tuple(_from_record(child) for child in values.get("children", ()))
    values["requires"] = tuple(str(uid) for uid in values.get("requires", ()))
    for child in values["children"]:
        if child.kind not in MAY_HOLD[values["kind"]]:
            raise UniSGError(f"a {values['kind']} cannot hold the {child.kind} {child.name or child.uid!r}")
    return LessonNode(**values, extra=record)

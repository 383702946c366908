"""The Lesson-Stage-Action tree (LSA): in which order actions are to be performed."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from ..errors import UniSGError
from ..runtime.json_records import check_version, from_record, parse_json, to_record

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
    return json.dumps(to_record(operation) | {"version": VERSION}, ensure_ascii=False, sort_keys=True)


def lesson_from_json(text: str) -> LessonNode:
    """An operation from the value of the custom property ``unisg_lsa``.

    Raises
    ------
    UniSGError
        If the text is no JSON object of that form, or was written by a newer version.
    """
    record = parse_json(text, "unisg_lsa")
    if not isinstance(record, dict) or record.get("kind") != "operation":
        raise UniSGError("unisg_lsa must be a JSON object whose kind is 'operation'")
    check_version(record.pop("version", VERSION), "this lesson has", VERSION)
    operation = from_record(LessonNode, record, "lesson node")
    for node in operation.walk():
        for child in node.children:
            if child.kind not in KINDS:
                raise UniSGError(f"lesson node {child.uid!r}: 'kind' must be one of {', '.join(KINDS)}")
            if child.kind not in MAY_HOLD[node.kind]:
                raise UniSGError(f"{node.kind} {node.uid!r} cannot hold the {child.kind} {child.name or child.uid!r}")
    return operation

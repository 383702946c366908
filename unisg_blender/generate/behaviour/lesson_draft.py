"""Extends a lesson tree by leaves and the stages and lessons above them; nothing that was there changes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ...behaviour.lesson.edit import find, insert, parent_of
from ...scene import LessonNode
from .action_kinds import Kinds, StageKind

UidMaker = Callable[[str], str]


class LessonDraft:
    """A lesson that grows; ``operation`` is the tree so far, None before the first leaf of a new one."""

    def __init__(self, operation: LessonNode | None, kinds: Kinds, make_uid: UidMaker) -> None:
        self.operation = operation
        self._kinds, self._make_uid = kinds, make_uid
        self._new: set[str] = set()

    def add_leaf(self, leaf: LessonNode, stage: str, after: str) -> None:
        """Put a leaf into the stage of that name behind the leaf with the uid ``after`` ("" for the first place)."""
        holder = self._stage(stage)
        order = [child.uid for child in holder.children]
        place = order.index(after) + 1 if after in order else 0
        assert self.operation is not None
        self.operation = insert(self.operation, holder.uid, leaf, place)

    def stage_of(self, name: str) -> LessonNode | None:
        """The first stage of a name."""
        nodes = () if self.operation is None else self.operation.walk()
        return next((node for node in nodes if node.kind == "stage" and node.name == name), None)

    def finished(self) -> LessonNode | None:
        """The tree, in which the new stages require what such stages usually do, as far as it is there."""
        tree = self.operation
        for uid in sorted(self._new):
            assert tree is not None
            stage = find(tree, uid)
            if stage is not None and stage.kind == "stage":
                tree = self._with_requires(tree, stage)
        return tree

    def _with_requires(self, tree: LessonNode, stage: LessonNode) -> LessonNode:
        above, node = {stage.uid}, parent_of(tree, stage.uid)
        while node is not None:
            above.add(node.uid)
            node = parent_of(tree, node.uid)
        known: dict[str, str] = {}
        for node in tree.walk():
            if node.uid not in above:
                known.setdefault(node.name, node.uid)
        needs = tuple(known[name] for name in self._record(stage.name).requires if name in known)
        return _changed(tree, stage.uid, requires=needs)

    def _record(self, name: str) -> StageKind:
        return self._kinds.stages[self._kinds.stage_number[name]]

    def _stage(self, name: str) -> LessonNode:
        """The stage of that name, made with the lessons above it if it is not there."""
        found = self.stage_of(name)
        if found is not None:
            return found
        record = self._record(name)
        if self.operation is None:
            self.operation = LessonNode("operation", self._make_uid("operation"), self._kinds.operation)
        holder = self.operation
        for lesson in record.lessons or ("Lesson",):
            below = next((node for node in holder.children if node.kind == "lesson" and node.name == lesson), None)
            holder = below or self._put(holder, LessonNode("lesson", self._make_uid("lesson"), lesson), record.rank)
        stage = LessonNode("stage", self._make_uid("stage"), name, ordered=record.ordered)
        return self._put(holder, stage, record.rank)

    def _put(self, holder: LessonNode, node: LessonNode, rank: float) -> LessonNode:
        """Put a part among its sisters where its rank belongs."""
        assert self.operation is not None
        here = find(self.operation, holder.uid)
        assert here is not None
        ranks = [self._rank(child) for child in here.children]
        before = [place for place, other in enumerate(ranks) if other is not None and other <= rank]
        later = [place for place, other in enumerate(ranks) if other is not None and other > rank]
        place = before[-1] + 1 if before else later[0] if later else len(ranks)
        self.operation = insert(self.operation, here.uid, node, place)
        self._new.add(node.uid)
        return node

    def _rank(self, node: LessonNode) -> float | None:
        ranks = [
            self._record(each.name).rank
            for each in node.walk()
            if each.kind == "stage" and each.name in self._kinds.stage_number
        ]
        return float(np.mean(ranks)) if ranks else None


def _map(node: LessonNode, edit: Callable[[LessonNode], LessonNode]) -> LessonNode:
    return replace(edit(node), children=tuple(_map(child, edit) for child in node.children))


def _changed(tree: LessonNode, uid: str, **values: object) -> LessonNode:
    return _map(tree, lambda node: replace(node, **values) if node.uid == uid else node)  # type: ignore[arg-type]

"""Extends a lesson tree by leaves and the stages and lessons above them; nothing that was there changes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ...behaviour.lesson.edit import change, find, insert
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
        operation, holder = self._with_stage(stage)
        order = [child.uid for child in holder.children]
        self.operation = insert(operation, holder.uid, leaf, order.index(after) + 1 if after in order else 0)

    def stage_of(self, name: str) -> LessonNode | None:
        """The first stage of a name."""
        nodes = () if self.operation is None else self.operation.walk()
        return next((node for node in nodes if node.kind == "stage" and node.name == name), None)

    def finished(self) -> LessonNode | None:
        """The tree, in which the new stages require what such stages usually do, as far as it is there."""
        tree = self.operation
        for stage in [] if tree is None else [node for node in tree.walk() if node.uid in self._new]:
            if tree is not None and stage.kind == "stage":
                tree = self._with_requires(tree, stage)
        return tree

    def _with_requires(self, tree: LessonNode, stage: LessonNode) -> LessonNode:
        known: dict[str, str] = {}
        for node in tree.walk():
            if find(node, stage.uid) is None:  # not itself, and nothing above it
                known.setdefault(node.name, node.uid)
        needs = tuple(known[name] for name in self._record(stage.name).requires if name in known)
        return change(tree, stage.uid, lambda node: replace(node, requires=needs))

    def _record(self, name: str) -> StageKind:
        return self._kinds.stages[self._kinds.stage_number[name]]

    def _with_stage(self, name: str) -> tuple[LessonNode, LessonNode]:
        """The tree with the stage of that name, made with the lessons above it if it is not there, and the stage."""
        stage, tree = self.stage_of(name), self.operation
        if stage is not None and tree is not None:
            return tree, stage
        record = self._record(name)
        tree = holder = tree or LessonNode("operation", self._make_uid("operation"), self._kinds.operation)
        for lesson in record.lessons or ("Lesson",):
            below = next((node for node in holder.children if node.kind == "lesson" and node.name == lesson), None)
            if below is None:
                below = LessonNode("lesson", self._make_uid("lesson"), lesson)
                tree = self._put(tree, holder.uid, below, record.rank)
            holder = below
        stage = LessonNode("stage", self._make_uid("stage"), name, ordered=record.ordered)
        return self._put(tree, holder.uid, stage, record.rank), stage

    def _put(self, tree: LessonNode, holder: str, node: LessonNode, rank: float) -> LessonNode:
        """The tree with a part put among its sisters where its rank belongs."""
        here = find(tree, holder)
        ranks = [] if here is None else [self._rank(child) for child in here.children]
        before = [position for position, other in enumerate(ranks) if other is not None and other <= rank]
        later = [position for position, other in enumerate(ranks) if other is not None and other > rank]
        self._new.add(node.uid)
        return insert(tree, holder, node, before[-1] + 1 if before else later[0] if later else len(ranks))

    def _rank(self, node: LessonNode) -> float | None:
        stages = (each for each in node.walk() if each.kind == "stage" and each.name in self._kinds.stage_number)
        ranks = [self._record(each.name).rank for each in stages]
        return float(np.mean(ranks)) if ranks else None

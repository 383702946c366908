"""Learns the kinds of actions and the shape of lessons from training scenes: counts, medians, rules that hold."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields

import numpy as np

from ...behaviour import all_actions, operations
from ...scene import LessonNode, SceneGraph, Thresholds
from .action_kinds import Kind, Kinds, StageKind
from .answer_rules import Asked, asked_of, learn_answer_rule
from .reference_poses import PoseSample, learn_reference, sample_of
from .roled_actions import SLOTS, Key, RoledAction, read_roled_actions

MOST_KINDS = 256
SAMPLES = 400
"""Reference poses and questions looked at for each kind, at most."""

SeenStage = tuple[LessonNode, tuple[str, ...], float, tuple[str, ...]]
"""A stage, the lessons above it, its rank among all stages (0 to 1), and the names of what it requires."""


@dataclass(eq=False)
class _Seen:
    """What was seen of one kind."""

    roled_actions: list[RoledAction]
    per_scene: list[int]
    ranks: list[float]
    slots: tuple[Counter[str], Counter[str], Counter[str]]
    poses: list[PoseSample]
    asked: list[Asked]


def learn_kinds(graphs: Iterable[SceneGraph]) -> Kinds:
    """The kinds of actions of some scenes; of rare ones (seen in one scene of many) nothing is kept."""
    seen: dict[Key, _Seen] = {}
    stages: dict[str, list[SeenStage]] = defaultdict(list)
    counts: list[Counter[str]] = []
    groups: dict[str, Counter[str]] = defaultdict(Counter)
    names: Counter[str] = Counter()
    for graph in graphs:
        counts.append(Counter(graph.category_name(row) for row in range(len(graph)) if graph.category[row] >= 0))
        _watch(graph, seen)
        for action in all_actions(graph):
            if action.type == "Parallel":
                groups[action.name][action.mode] += 1
        for operation in operations(graph):
            names[operation.name] += 1
            _watch_stages(operation, stages)
    least = 2 if len(counts) >= 20 else 1
    often = sorted((-len(one.per_scene), key) for key, one in seen.items() if len(one.per_scene) >= least)
    return Kinds(
        categories=tuple(sorted(set().union(*counts))),
        kinds=tuple(_kind(key, seen[key], counts) for _, key in often[:MOST_KINDS]),
        stages=tuple(_stage(name, found) for name, found in sorted(stages.items())),
        groups={name: modes.most_common(1)[0][0] for name, modes in sorted(groups.items())},
        operation=names.most_common(1)[0][0] if names else "Operation",
    )


def _watch(graph: SceneGraph, seen: dict[Key, _Seen]) -> None:
    roled_actions = read_roled_actions(graph)
    for key, number in Counter(roled.key for roled in roled_actions).items():
        empty = Counter[str](), Counter[str](), Counter[str]()
        seen.setdefault(key, _Seen([], [], [], empty, [], [])).per_scene.append(number)
    for roled in roled_actions:
        one = seen[roled.key]
        one.roled_actions.append(roled)
        for counter, row in zip(one.slots, roled.slots, strict=True):
            if row >= 0:
                counter[graph.category_name(row)] += 1
        if roled.stage is not None and roled.order >= 0:
            one.ranks.append((roled.order + 0.5) / len(roled.stage.children))
        if roled.action.reference is not None and len(one.poses) < SAMPLES:
            one.poses.append(sample_of(graph, roled))
        if roled.action.type == "Question" and len(one.asked) < SAMPLES:
            one.asked.append(asked_of(graph, roled))


def _watch_stages(operation: LessonNode, stages: dict[str, list[SeenStage]]) -> None:
    name_of = {node.uid: node.name for node in operation.walk()}
    found: list[tuple[LessonNode, tuple[str, ...]]] = []

    def walk(node: LessonNode, above: tuple[str, ...]) -> None:
        """Collect the stages below a node with the names of the lessons above them."""
        for child in node.children:
            if child.kind == "stage":
                found.append((child, above))
            elif child.kind == "lesson":
                walk(child, (*above, child.name))

    walk(operation, ())
    for position, (stage, above) in enumerate(found):
        needs = tuple(name_of[uid] for uid in stage.requires if uid in name_of)
        stages[stage.name].append((stage, above, (position + 0.5) / len(found), needs))


def _stage(name: str, found: Sequence[SeenStage]) -> StageKind:
    needs = Counter(need for _, _, _, requires in found for need in set(requires))
    return StageKind(
        name,
        Counter(above for _, above, _, _ in found).most_common(1)[0][0],
        round(float(np.mean([rank for _, _, rank, _ in found])), 4),
        tuple(sorted(need for need, count in needs.items() if count * 2 > len(found))),
        sum(stage.ordered for stage, _, _, _ in found) * 2 >= len(found),
    )


def _kind(key: Key, one: _Seen, counts: Sequence[Counter[str]]) -> Kind:
    kind, name, stage, group = key
    target, tool, frame = map(dict, one.slots)
    total = sum(counts, Counter[str]())
    return Kind(
        type=kind, name=name, stage=stage, group=group, slots=(target, tool, frame),
        roles={
            f"{slot}|{category}": round(number / total[category], 4)
            for slot, found in zip(SLOTS, one.slots, strict=True)
            for category, number in found.items()
            if total[category]
        },
        chance=_chance(one, counts),
        most=max(one.per_scene),
        rank=round(float(np.mean(one.ranks)), 4) if one.ranks else 0.5,
        thresholds=_limits(one.roled_actions),
        optional=_mostly([roled.leaf is not None and roled.leaf.optional for roled in one.roled_actions]),
        trigger=_mostly([roled.action.trigger for roled in one.roled_actions]),
        reference=learn_reference(one.poses),
        answers=one.roled_actions[0].action.answers,
        answer_rule=learn_answer_rule(one.asked),
    )  # fmt: skip


def _mostly(flags: Sequence[bool]) -> bool:
    return sum(flags) * 2 > len(flags)


def _chance(one: _Seen, counts: Sequence[Counter[str]]) -> float:
    """Share of the scenes with an object for each role in which the kind occurs."""
    able = sum(all(any(count[name] for name in role) for role in one.slots if role) for count in counts)
    return round(min(len(one.per_scene) / max(able, 1), 1.0), 4)


def _limits(roled_actions: Sequence[RoledAction]) -> dict[str, float]:
    limits = {}
    for name in (item.name for item in fields(Thresholds)):
        values = [getattr(roled.action.thresholds, name) for roled in roled_actions]
        known = [value for value in values if value is not None]
        if len(known) * 2 >= len(values):
            middle = float(np.median(known))
            limits[name] = float(round(middle)) if name == "hits" else round(middle, 6)
    return limits

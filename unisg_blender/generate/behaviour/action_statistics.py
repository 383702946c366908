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

LIMITS = tuple(item.name for item in fields(Thresholds))
Slots = tuple[dict[str, int], dict[str, int], dict[str, int]]


@dataclass(eq=False)
class _Seen:
    """What was seen of one kind."""

    roled: list[RoledAction]
    per_scene: list[int]
    ranks: list[float]
    slots: tuple[Counter[str], Counter[str], Counter[str]]
    poses: list[PoseSample]
    asked: list[Asked]


def learn_kinds(graphs: Iterable[SceneGraph]) -> Kinds:
    """The kinds of actions of some scenes; of rare ones (seen in one scene of many) nothing is kept."""
    seen: dict[Key, _Seen] = {}
    stages: dict[str, list[tuple[LessonNode, tuple[str, ...], float, tuple[str, ...]]]] = defaultdict(list)
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
    often = sorted((key for key in seen if len(seen[key].per_scene) >= least), key=lambda key: _order(seen, key))
    return Kinds(
        categories=tuple(sorted(set().union(*counts))),
        kinds=tuple(_kind(key, seen[key], counts) for key in often[:MOST_KINDS]),
        stages=tuple(_stage(name, found) for name, found in sorted(stages.items())),
        groups={name: modes.most_common(1)[0][0] for name, modes in sorted(groups.items())},
        operation=names.most_common(1)[0][0] if names else "Operation",
    )


def _order(seen: dict[Key, _Seen], key: Key) -> tuple[float, Key]:
    return -len(seen[key].per_scene), key


def _watch(graph: SceneGraph, seen: dict[Key, _Seen]) -> None:
    roled = read_roled_actions(graph)
    for key, number in Counter(roled_action.key for roled_action in roled).items():
        empty = Counter[str](), Counter[str](), Counter[str]()
        seen.setdefault(key, _Seen([], [], [], empty, [], [])).per_scene.append(number)
    for roled_action in roled:
        one = seen[roled_action.key]
        one.roled.append(roled_action)
        for counter, row in zip(one.slots, roled_action.slots, strict=True):
            if row >= 0:
                counter[graph.category_name(row)] += 1
        if roled_action.stage is not None and roled_action.order >= 0:
            one.ranks.append((roled_action.order + 0.5) / len(roled_action.stage.children))
        if roled_action.action.reference is not None and len(one.poses) < SAMPLES:
            one.poses.append(sample_of(graph, roled_action))
        if roled_action.action.type == "Question" and len(one.asked) < SAMPLES:
            one.asked.append(asked_of(graph, roled_action))


def _watch_stages(
    operation: LessonNode, stages: dict[str, list[tuple[LessonNode, tuple[str, ...], float, tuple[str, ...]]]]
) -> None:
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
    for place, (stage, above) in enumerate(found):
        needs = tuple(name_of[uid] for uid in stage.requires if uid in name_of)
        stages[stage.name].append((stage, above, (place + 0.5) / len(found), needs))


def _stage(name: str, found: Sequence[tuple[LessonNode, tuple[str, ...], float, tuple[str, ...]]]) -> StageKind:
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
    slots: Slots = (dict(one.slots[0]), dict(one.slots[1]), dict(one.slots[2]))
    total = sum(counts, Counter[str]())
    first = one.roled[0]
    return Kind(
        type=kind, name=name, stage=stage, group=group, slots=slots,
        roles={
            f"{slot}|{category}": round(number / total[category], 4)
            for slot, found in zip(SLOTS, slots, strict=True)
            for category, number in found.items()
            if total[category]
        },
        chance=_chance(one, counts),
        most=max(one.per_scene),
        rank=round(float(np.mean(one.ranks)), 4) if one.ranks else 0.5,
        thresholds=_limits(one.roled),
        optional=_mostly([roled_action.leaf is not None and roled_action.leaf.optional for roled_action in one.roled]),
        trigger=_mostly([roled_action.action.trigger for roled_action in one.roled]),
        reference=learn_reference(one.poses),
        answers=first.action.answers,
        right=learn_answer_rule(one.asked),
    )  # fmt: skip


def _mostly(flags: Sequence[bool]) -> bool:
    return sum(flags) * 2 > len(flags)


def _chance(one: _Seen, counts: Sequence[Counter[str]]) -> float:
    """Share of the scenes with an object for each part in which the kind occurs."""
    parts = [set(found) for found in one.slots if found]
    able = sum(all(any(count[name] for name in part) for part in parts) for count in counts)
    return round(min(len(one.per_scene) / max(able, 1), 1.0), 4)


def _limits(roled: Sequence[RoledAction]) -> dict[str, float]:
    found = {}
    for name in LIMITS:
        values = [
            value for roled_action in roled if (value := getattr(roled_action.action.thresholds, name)) is not None
        ]
        if len(values) * 2 >= len(roled):
            middle = float(np.median(values))
            found[name] = float(round(middle)) if name == "hits" else round(middle, 6)
    return found

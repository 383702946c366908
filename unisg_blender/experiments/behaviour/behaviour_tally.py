"""Counts how much of the behaviour that objects had was made again, as :mod:`.behaviour_benchmark` defines it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from ...behaviour import all_actions
from ...generate.behaviour.action_kinds import Kinds
from ...generate.behaviour.roled_actions import RoledAction, read_roled_actions
from ...scene import SceneGraph, Thresholds

USUAL = 0.9


@dataclass(frozen=True)
class BehaviourRow:
    """Measures of one policy, see :mod:`.behaviour_benchmark`; shares in 0..1, processor ms per object (median).

    ``played`` is NaN (None in the record) where nothing was played.
    """

    name: str
    scenes: int
    actions: int
    recall: float
    precision: float
    exact: float
    entities: float
    usual_recall: float
    stage: float
    order: float
    thresholds: float
    pose_cm: float
    pose_degrees: float
    answers: float
    sound: float
    played: float
    milliseconds: float

    def to_record(self) -> dict[str, float | int | str | None]:
        """JSON-ready."""
        record = {key: round(value, 4) if isinstance(value, float) else value for key, value in self.__dict__.items()}
        return {key: None if value != value else value for key, value in record.items()}


@dataclass(frozen=True, eq=False)
class BehaviourCase:
    """A scene without the actions of one object; ``bare``, with its uid there; ``real`` is the scene before."""

    real: SceneGraph
    bare: SceneGraph
    uid: str
    gone: tuple[RoledAction, ...]


class Tally:
    """Counts over cases."""

    def __init__(self, kinds: Kinds) -> None:
        self.kinds = kinds
        self.counts: Counter[str] = Counter()
        self.thresholds: list[float] = []
        self.poses: list[tuple[float, float]] = []
        self.sound: list[bool] = []
        self.played: list[bool] = []

    def add(self, case: BehaviourCase, scene: SceneGraph, uid: str) -> None:
        """Compare what was made with what had been there."""
        real = case.real
        uids = {action.uid for action in all_actions(case.bare)}
        made = [roled for roled in read_roled_actions(scene) if roled.action.uid not in uids]
        moved = {uid: next(iter(set(real.uid) - set(case.bare.uid)), uid)}
        wanted, got = (
            Counter(_assignment(real, roled) for roled in case.gone),
            Counter(_assignment(scene, roled) for roled in made),
        )
        right = sum((wanted & got).values())
        exact = Counter(_participants(real, roled, {}) for roled in case.gone) & Counter(
            _participants(scene, roled, moved) for roled in made
        )
        usual = Counter(_assignment(real, roled) for roled in case.gone if self._usual(roled))
        self.counts += Counter(
            wanted=sum(wanted.values()), made=sum(got.values()), right=right, entities=sum(exact.values()),
            exact=int(wanted == got), usual=sum(usual.values()), usual_right=sum((usual & got).values()),
        )  # fmt: skip
        self._pairs(case, scene, made)

    def _usual(self, roled: RoledAction) -> bool:
        number = self.kinds.number_of.get(roled.key, -1)
        return number >= 0 and self.kinds.kinds[number].chance >= USUAL

    def _pairs(self, case: BehaviourCase, scene: SceneGraph, made: Sequence[RoledAction]) -> None:
        """Compare place, limits and poses of the right ones."""
        left = list(made)
        for roled in case.gone:
            twin = next((other for other in left if _assignment(scene, other) == _assignment(case.real, roled)), None)
            if twin is None:
                continue
            left.remove(twin)
            if roled.stage is not None:
                self.counts["placed"] += 1
                self.counts["stage"] += twin.stage is not None and twin.stage.name == roled.stage.name
                self._order(roled, twin)
            if roled.action.type == "Question":
                self.counts["asked"] += 1
                self.counts["answered"] += _answer(roled) == _answer(twin)
            for limit in fields(Thresholds):
                true, value = (getattr(each.action.thresholds, limit.name) for each in (roled, twin))
                if true:
                    self.thresholds.append(abs((value or 0.0) - true) / true)
            self._pose(roled, twin)

    def _order(self, roled: RoledAction, twin: RoledAction) -> None:
        if roled.stage is None or twin.stage is None or not roled.stage.ordered or roled.leaf is None:
            return
        before = [leaf.name for leaf in roled.stage.children]
        after = [leaf.name for leaf in twin.stage.children]
        if before.count(roled.action.name) != 1 or after.count(twin.action.name) != 1:
            return
        for name in set(before) & set(after) - {roled.action.name}:
            self.counts["pairs"] += 1
            same = before.index(name) < before.index(roled.action.name)
            self.counts["ordered"] += same == (after.index(name) < after.index(twin.action.name))

    def _pose(self, roled: RoledAction, twin: RoledAction) -> None:
        true, pose = roled.action.reference_matrix, twin.action.reference_matrix
        if true is not None and pose is not None:
            apart = 100 * float(np.linalg.norm(true[:3, 3] - pose[:3, 3]))
            turn = np.clip((np.trace(true[:3, :3].T @ pose[:3, :3]) - 1) / 2, -1, 1)
            self.poses.append((apart, float(np.degrees(np.arccos(turn)))))

    def row(self, name: str, scenes: int, milliseconds: float) -> BehaviourRow:
        """The measures."""
        n = self.counts
        poses = np.mean(self.poses, axis=0).tolist() if self.poses else (0.0, 0.0)
        return BehaviourRow(
            name, scenes, n["wanted"], _share(n["right"], n["wanted"]), _share(n["right"], n["made"]),
            _share(n["exact"], scenes), _share(n["entities"], n["wanted"]), _share(n["usual_right"], n["usual"]),
            _share(n["stage"], n["placed"]), _share(n["ordered"], n["pairs"]),
            float(np.mean(self.thresholds)) if self.thresholds else 0.0, poses[0], poses[1],
            _share(n["answered"], n["asked"]), _mean(self.sound), _mean(self.played), milliseconds,
        )  # fmt: skip


def _assignment(graph: SceneGraph, roled: RoledAction) -> tuple[object, ...]:
    """What has to agree for an action to be right."""
    return *roled.key[:3], *(graph.category_name(row) if row >= 0 else "" for row in roled.slots)


def _participants(graph: SceneGraph, roled: RoledAction, moved: dict[str, str]) -> tuple[object, ...]:
    """The same with the objects themselves."""
    uids = (graph.uid[row] if row >= 0 else "" for row in roled.slots)
    return *roled.key[:3], *(moved.get(uid, uid) for uid in uids)


def _answer(roled: RoledAction) -> set[str]:
    return {roled.action.answers[place] for place in roled.action.correct}


def _share(part: float, whole: float) -> float:
    return part / whole if whole else 1.0


def _mean(flags: Sequence[bool]) -> float:
    return float(np.mean(flags)) if flags else float("nan")

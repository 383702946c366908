"""How well new things get their behaviour: things of real scenes lose their actions and get them again.

A thing is taken that plays in actions (as target, tool or frame). All actions in
which it plays are taken out of the scene with their leaves, groups lose them as
members, parts of the lesson that hold nothing more go too; the thing itself stays
where it is, with a new uid. Then behaviour is generated for it and compared:

- *right*: an action of the same type, name and stage, whose target, tool and
  frame have the same categories; ``entities``: are the same things;
- *recall* = right / actions taken out, *precision* = right / actions made, *exact* = share
  of the things with all of them right and none too many;
- *usual recall*: the same over kinds that at least nine in ten training scenes with
  their parts have: what remains is not decided by a toss of the world's coins;
- *stage*: right actions whose leaf is in the stage it was in; *order*: share of the pairs of a right action's leaf
  and another leaf of its ordered stage that stand in the same order as before;
- *thresholds*: mean of |made - true| / true over all thresholds of right actions; *poses*: mean distance of
  reference poses in centimetres and angle in degrees; *answers*: share of questions with the right answer;
- *sound*: share of the scenes in which ``check_scene`` finds nothing new; *played*: in which
  the whole lesson is rehearsed and then played to its end.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, fields

import numpy as np

from ..errors import UniSGError
from ..generate.behaviour.acts import Act, read_acts
from ..generate.behaviour.add import Behaviour, add_behaviour
from ..generate.behaviour.choice import Chooser
from ..generate.behaviour.kinds import Kinds
from ..generate.extend import uid_maker
from ..scene import SceneGraph, Thresholds
from ..scene.behaviour import check_scene, moments, operations, prepare, rehearse, simulate
from .behaviour_removal import without_behaviour

USUAL = 0.9
RATE = 2.0
"""Frames per second of the rehearsal."""


@dataclass(frozen=True)
class BehaviourRow:
    """Measures of one chooser, see the module; shares in 0..1, milliseconds of processor time per thing (median)."""

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

    def to_record(self) -> dict[str, float | int | str]:
        """JSON-ready."""
        return {key: round(value, 4) if isinstance(value, float) else value for key, value in self.__dict__.items()}


@dataclass(frozen=True, eq=False)
class BehaviourCase:
    """A scene without the actions of one thing: ``bare``, with the thing's uid there; ``real`` is the scene before."""

    real: SceneGraph
    bare: SceneGraph
    uid: str
    gone: tuple[Act, ...]


def behaviour_cases(graphs: Iterable[SceneGraph], seed: int, acting: bool = True) -> list[BehaviourCase]:
    """A case of each scene: a thing drawn among those that play in actions (or, without ``acting``, among those that
    do not although others of their category do)."""
    rng, cases = np.random.default_rng(seed), []
    for graph in graphs:
        acts = read_acts(graph)
        rows = sorted({row for act in acts for row in act.slots if row >= 0})
        if not acting:
            names = {graph.category_name(row) for row in rows}
            rows = [row for row in range(len(graph)) if row not in rows and graph.category_name(row) in names]
        if rows:
            row = int(rng.choice(rows))
            bare, uid = without_behaviour(graph, row)
            cases.append(BehaviourCase(graph, bare, uid, tuple(act for act in acts if row in act.slots)))
    return cases


def measure_behaviour(
    name: str, cases: Sequence[BehaviourCase], chooser: Chooser, seed: int = 0, play: int | None = None,
    progress: Callable[[int], None] = lambda done: None,
) -> BehaviourRow:  # fmt: skip
    """Generate behaviour for the thing of each case and compare; ``play`` limits the cases that are played."""
    tally, spent = _Tally(chooser.kinds), []
    for number, case in enumerate(cases):
        start = time.process_time()
        result = add_behaviour(case.bare, [case.uid], chooser, uid_maker(case.bare, seed + number))
        spent.append(1e3 * (time.process_time() - start))
        tally.add(case, result)
        tally.sound.append(is_sound(case.bare, result.scene))
        if play is None or number < play:
            tally.played.append(plays_to_the_end(result.scene))
        progress(number)
    return tally.row(name, len(cases), float(np.median(spent)) if spent else 0.0)


def is_sound(before: SceneGraph, after: SceneGraph) -> bool:
    """Whether ``check_scene`` finds nothing in the scene that it did not find before."""
    known = {(problem.uid, problem.message) for problem in check_scene(before)}
    return all((problem.uid, problem.message) in known for problem in check_scene(after))


def plays_to_the_end(graph: SceneGraph) -> bool:
    """Whether all lessons of a scene can be rehearsed and the rehearsal plays them to their ends."""
    try:
        for operation in operations(graph):
            lesson = prepare(graph, operation)
            if not simulate(lesson, moments(graph, rehearse(lesson, RATE))).finished:
                return False
    except UniSGError:
        return False
    return True


class _Tally:
    """Counts over cases."""

    def __init__(self, kinds: Kinds) -> None:
        self.kinds = kinds
        self.counts: Counter[str] = Counter()
        self.thresholds: list[float] = []
        self.poses: list[tuple[float, float]] = []
        self.sound: list[bool] = []
        self.played: list[bool] = []

    def add(self, case: BehaviourCase, result: Behaviour) -> None:
        """Compare what was made with what had been there."""
        real, scene = case.real, result.scene
        uids = {action.uid for action in case.bare.components["actions"].columns["data"]} if _has(case.bare) else set()
        made = [act for act in read_acts(scene) if act.action.uid not in uids]
        moved = {case.uid: next(iter(set(real.uid) - set(case.bare.uid)), case.uid)}
        wanted, got = Counter(_cast(real, act) for act in case.gone), Counter(_cast(scene, act) for act in made)
        right = sum((wanted & got).values())
        exact = Counter(_things(real, act, {}) for act in case.gone) & Counter(
            _things(scene, act, moved) for act in made
        )
        usual = Counter(cast for act in case.gone if self._usual(act) for cast in [_cast(real, act)])
        self.counts += Counter(
            wanted=sum(wanted.values()), made=sum(got.values()), right=right, entities=sum(exact.values()),
            exact=int(wanted == got), usual=sum(usual.values()), usual_right=sum((usual & got).values()),
        )  # fmt: skip
        self._pairs(case, scene, made)

    def _usual(self, act: Act) -> bool:
        number = self.kinds.number_of.get(act.key, -1)
        return number >= 0 and self.kinds.kinds[number].chance >= USUAL

    def _pairs(self, case: BehaviourCase, scene: SceneGraph, made: Sequence[Act]) -> None:
        """Compare place, limits and poses of the right ones."""
        left = list(made)
        for act in case.gone:
            twin = next((other for other in left if _cast(scene, other) == _cast(case.real, act)), None)
            if twin is None:
                continue
            left.remove(twin)
            if act.stage is not None:
                self.counts["placed"] += 1
                self.counts["stage"] += twin.stage is not None and twin.stage.name == act.stage.name
                self._order(act, twin)
            if act.action.type == "Question":
                self.counts["asked"] += 1
                self.counts["answered"] += _answer(act) == _answer(twin)
            for limit in fields(Thresholds):
                true, value = (getattr(each.action.thresholds, limit.name) for each in (act, twin))
                if true:
                    self.thresholds.append(abs((value or 0.0) - true) / true)
            self._pose(act, twin)

    def _order(self, act: Act, twin: Act) -> None:
        if act.stage is None or twin.stage is None or not act.stage.ordered or act.leaf is None:
            return
        before = [leaf.name for leaf in act.stage.children]
        after = [leaf.name for leaf in twin.stage.children]
        if before.count(act.action.name) != 1 or after.count(twin.action.name) != 1:
            return
        for name in set(before) & set(after) - {act.action.name}:
            self.counts["pairs"] += 1
            same = before.index(name) < before.index(act.action.name)
            self.counts["ordered"] += same == (after.index(name) < after.index(twin.action.name))

    def _pose(self, act: Act, twin: Act) -> None:
        true, pose = act.action.reference_matrix, twin.action.reference_matrix
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


def _has(graph: SceneGraph) -> bool:
    return "actions" in graph.components


def _cast(graph: SceneGraph, act: Act) -> tuple[object, ...]:
    """What has to agree for an action to be right."""
    return *act.key[:3], *(graph.category_name(row) if row >= 0 else "" for row in act.slots)


def _things(graph: SceneGraph, act: Act, moved: dict[str, str]) -> tuple[object, ...]:
    """The same with the things themselves."""
    uids = (graph.uid[row] if row >= 0 else "" for row in act.slots)
    return *act.key[:3], *(moved.get(uid, uid) for uid in uids)


def _answer(act: Act) -> set[str]:
    return {act.action.answers[place] for place in act.action.correct}


def _share(part: float, whole: float) -> float:
    return part / whole if whole else 1.0


def _mean(flags: Sequence[bool]) -> float:
    return float(np.mean(flags)) if flags else 1.0

"""How well new objects get their behaviour: objects of real scenes lose their actions and get them again.

An object is taken that takes part in actions (as target, tool or frame). All actions in
which it takes part are taken out of the scene with their leaves, groups lose them as
members, parts of the lesson that hold nothing more go too; the object itself stays
where it is, with a new uid. Then behaviour is generated for it and compared:

- *right*: an action of the same type, name and stage, whose target, tool and
  frame have the same categories; ``entities``: are the same objects;
- *recall* = right / actions taken out, *precision* = right / actions made, *exact* = share
  of the objects with all of them right and none too many;
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
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...behaviour import check_scene, moments, operations, prepare, rehearse, simulate
from ...dataset.assets.asset import object_graph
from ...errors import UniSGError
from ...generate.behaviour.action_kinds import Kinds
from ...generate.behaviour.action_policy import ActionPolicy
from ...generate.behaviour.behaviour_adder import add_behaviour
from ...generate.behaviour.frequency_policy import FrequencyPolicy, LackingPolicy
from ...generate.behaviour.roled_actions import read_roled_actions
from ...generate.place.scene_extension import uid_maker
from ...scene import SceneGraph, subtree, take
from ...scene.categories import STRUCTURE
from .behaviour_removal import without_behaviour
from .behaviour_tally import BehaviourCase, BehaviourRow, Tally

if TYPE_CHECKING:
    from ...generate import Generator

RATE = 2.0
"""Frames per second of the rehearsal."""


def behaviour_cases(graphs: Iterable[SceneGraph], seed: int, acting: bool = True) -> list[BehaviourCase]:
    """A case of each scene: an object drawn among those that take part in actions (or, without ``acting``, among those
    that do not although others of their category do)."""
    rng, cases = np.random.default_rng(seed), []
    for graph in graphs:
        roled_actions = read_roled_actions(graph)
        rows = sorted({row for roled in roled_actions for row in roled.slots if row >= 0})
        if not acting:
            names = {graph.category_name(row) for row in rows}
            rows = [row for row in range(len(graph)) if row not in rows and graph.category_name(row) in names]
        if rows:
            row = int(rng.choice(rows))
            bare, uid = without_behaviour(graph, row)
            cases.append(BehaviourCase(graph, bare, uid, tuple(roled for roled in roled_actions if row in roled.slots)))
    return cases


Make = Callable[[BehaviourCase, int], tuple[SceneGraph, str]]
"""Gives the object of a case its behaviour, with a seed: the scene and the object's uid there."""


def by_policy(policy: ActionPolicy, draws: bool = False) -> Make:
    """The object stays where it is and gets the actions that a policy wants; rarer ones by draw."""

    def make(case: BehaviourCase, seed: int) -> tuple[SceneGraph, str]:
        """The case's scene with behaviour by the policy, and the uid of its object."""
        rng = np.random.default_rng(seed) if draws else None
        return add_behaviour(case.bare, [case.uid], policy, uid_maker(case.bare, seed), rng).scene, case.uid

    return make


def by_generator(generator: Generator) -> Make:
    """The object goes, and the generator adds one of its category with the same shape where it thinks fit.

    For objects on which nothing stands; where it is refused, the scene comes back without it.
    """

    def make(case: BehaviourCase, seed: int) -> tuple[SceneGraph, str]:
        """The case's scene with its object placed and given behaviour by the generator, and the object's new uid."""
        row = case.bare.row_of_uid[case.uid]
        name, asset = case.bare.category_name(row), object_graph(case.bare, row)
        left = take(case.bare, np.setdiff1d(np.arange(len(case.bare)), subtree(case.bare, row)))
        made = generator.add(left, {name: 1}, seed, assets={name: [asset]})
        return made.scene, made.objects[0].uid

    return make


def compare_behaviour(
    generator: Generator, graphs: Sequence[SceneGraph], seed: int = 0, play: int | None = None,
    progress: Callable[[str], None] = lambda name: None,
) -> list[BehaviourRow]:  # fmt: skip
    """The table: the model's network and two simple rules in the same scenes, and the whole generator.

    Empty if the model has no behaviour beside it, or no scene has actions. The rules
    know what the model's training scenes taught, see :mod:`...generate.behaviour.frequency_policy`;
    ``play`` limits the scenes whose lessons are played.
    """
    network = generator.behaviour
    cases = behaviour_cases(graphs, seed) if network is not None else []
    if network is None or not cases:
        return []
    kinds, others = network.kinds, behaviour_cases(graphs, seed, acting=False)
    free = [case for case in cases if _is_free(case, generator)]
    runs: list[tuple[str, Sequence[BehaviourCase], Make]] = [
        ("network", cases, by_policy(network, draws=True)),
        ("what the lesson lacks, nearest", cases, by_policy(LackingPolicy(kinds))),
        ("most frequent, nearest", cases, by_policy(FrequencyPolicy(kinds))),
        ("network, placed by the generator", free, by_generator(generator)),
        ("network, things that had no actions", others, by_policy(network, draws=True)),
        ("what the lesson lacks, things that had none", others, by_policy(LackingPolicy(kinds))),
    ]
    rows = []
    for name, some, make in runs:
        progress(name)
        rows.append(measure_behaviour(name, some, make, kinds, seed, play))
    return rows


def count_right(generator: Generator, graphs: Sequence[SceneGraph], seed: int = 0) -> NDArray[np.float64]:
    """Actions taken out, those of them that the model's network makes again right, and made in all, (3,).

    Zeros if there is no behaviour beside the model.
    """
    if generator.behaviour is None:
        return np.zeros(3)
    make, tally = by_policy(generator.behaviour, draws=True), Tally(generator.behaviour.kinds)
    for number, case in enumerate(behaviour_cases(graphs, seed)):
        tally.add(case, *make(case, seed + number))
    return np.array([tally.counts[name] for name in ("wanted", "right", "made")], np.float64)


def _is_free(case: BehaviourCase, generator: Generator) -> bool:
    """If the generator knows the object, nothing with a category hangs below it, and it is no part of the shell."""
    row = case.bare.row_of_uid[case.uid]
    name, below = case.bare.category_name(row), subtree(case.bare, row)
    return name in generator.categories and name not in STRUCTURE and (case.bare.category[below] >= 0).sum() == 1


def measure_behaviour(
    name: str, cases: Sequence[BehaviourCase], make: Make, kinds: Kinds, seed: int = 0, play: int | None = None
) -> BehaviourRow:
    """Give the object of each case its behaviour and compare; ``play`` limits the cases that are played."""
    tally, spent = Tally(kinds), []
    for number, case in enumerate(cases):
        start = time.process_time()
        scene, uid = make(case, seed + number)
        spent.append(1e3 * (time.process_time() - start))
        tally.add(case, scene, uid)
        tally.sound.append(is_sound(case.bare, scene))
        if play is None or number < play:
            tally.played.append(plays_to_the_end(scene))
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

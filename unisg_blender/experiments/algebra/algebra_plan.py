"""Which trainings make up the comparison: tasks, networks, numbers of rooms, seeds."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

from ...learn.symmetry.room_questions import TASKS
from ...learn.symmetry.symmetry_networks import NETWORKS
from ..paper.runs import Run

FOREIGN_MOST = 100
"""Rooms of others that can be learned from: there are not many more."""


LONGER = 5
"""How many times the steps some trainings may take: does what is behind only learn more slowly?"""

LONG_TASK, LONG_ROOMS, LONG_SEEDS = "supports", 30, 3


@dataclass(frozen=True)
class AlgebraPlan:
    """Sizes of everything; a training ends after ``steps`` and ``seconds``, whichever comes last."""

    tasks: tuple[str, ...] = tuple(TASKS)
    rooms: tuple[int, ...] = (10, 30, 100, 300, 1000)
    seeds: int = 10
    parameters: int = 16_000
    steps: int = 200
    seconds: float = 3.0
    tests: int = 60


QUICK_PLAN = AlgebraPlan(("supports", "foreign kinds"), (10, 30), 2, steps=100, seconds=1.0, tests=20)


def algebra_runs(plan: AlgebraPlan, foreign: bool) -> list[Run]:
    """Seed by seed, few rooms first, so that what is there when it is stopped is balanced.

    Without ``foreign`` rooms what needs them to learn from is left out.
    """
    each = product(range(plan.seeds), plan.tasks, plan.rooms, NETWORKS)
    asked = [one for one in each if TASKS[one[1]].rooms != "foreign" or (foreign and one[2] <= FOREIGN_MOST)]
    return [_run(plan, *one, plan.steps, plan.seconds) for one in asked]


def long_runs(plan: AlgebraPlan) -> list[Run]:
    """A few trainings that may take :data:`LONGER` times the steps, however long that is."""
    if LONG_TASK not in plan.tasks or LONG_ROOMS not in plan.rooms:
        return []
    seeds = range(min(LONG_SEEDS, plan.seeds))
    return [
        _run(plan, seed, LONG_TASK, LONG_ROOMS, network, LONGER * plan.steps, 0.0)
        for seed in seeds
        for network in NETWORKS
    ]


def _run(plan: AlgebraPlan, seed: int, task: str, rooms: int, network: str, steps: int, seconds: float) -> Run:
    size = {"parameters": plan.parameters, "steps": steps, "seconds": seconds}
    return Run("algebra", {"task": task, "network": network, "rooms": rooms, "seed": seed, **size})

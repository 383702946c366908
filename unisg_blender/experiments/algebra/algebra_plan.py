"""Which trainings make up the comparison: tasks, networks, numbers of rooms, seeds."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

from ...learn.symmetry.room_questions import TASKS
from ...learn.symmetry.symmetry_networks import NETWORKS
from ..paper.runs import Run

FOREIGN_MOST = 100
"""Rooms of others that can be learned from: there are not many more."""


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
    size = {"parameters": plan.parameters, "steps": plan.steps, "seconds": plan.seconds}
    return [
        Run("algebra", {"task": task, "network": network, "rooms": rooms, "seed": seed, **size})
        for seed, task, rooms, network in product(range(plan.seeds), plan.tasks, plan.rooms, NETWORKS)
        if TASKS[task].rooms != "foreign" or (foreign and rooms <= FOREIGN_MOST)
    ]

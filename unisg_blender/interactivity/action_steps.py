"""Actions as steps of a graph: each with its own state, as :mod:`~..behaviour.fulfilment.action_state` moves it on."""

from __future__ import annotations

from dataclasses import dataclass

from ..behaviour.fulfilment.body_contact import EPSILON
from .behaviour_program import (
    NO,
    TIME,
    YES,
    Branch,
    Expression,
    GraphVariable,
    Put,
    Step,
    StepBlock,
    all_of,
    any_of,
    put,
    real,
    whole,
)


@dataclass(frozen=True, eq=False)
class ActionSteps:
    """One action in the graph.

    ``met``: its condition holds; ``struck``: in this tick it has held for long enough while waiting, and so ``enough``
    times; ``done``: performed, of what is no member of a group in this tick only; ``fair``: its condition did
    not hold at the start; ``late``: time alone may move it on. ``update`` moves them on, after ``passing``, what is of
    one tick only, was set to false.
    """

    met: GraphVariable
    struck: GraphVariable
    done: GraphVariable
    fair: GraphVariable
    enough: Expression
    late: Expression
    update: StepBlock
    variables: tuple[GraphVariable, ...]
    passing: tuple[GraphVariable, ...]


def action_steps(
    name: str,
    condition: list[list[Expression | Put]],
    hold: float,
    needed: int,
    active: Expression,
    waiting: Expression,
    member: bool,
    stirred: GraphVariable,
    again: Put,
) -> ActionSteps:
    """An action of whose ``condition`` one way, with all its parts, must hold for ``hold`` seconds ``needed`` times.

    ``active``: it may be performed; ``waiting``: not yet; it is one of both; ``member``: of a group, so that it may be
    active though it was performed; ``stirred`` is set where more than ``met`` has changed. Where time alone decides,
    ``again`` lets it be looked at in the next tick.
    """
    met, struck, counted, done, fair = (
        GraphVariable(f"{word} {name}", NO) for word in ("met", "struck", "counted", "done", "fair")
    )
    since, hits = GraphVariable(f"since {name}", real(0)), GraphVariable(f"hits {name}", whole(0))
    several, lasting = needed > 1, hold > 0
    enough = hits.value > whole(needed - 1) if several else YES
    counts = [(struck, waiting), (stirred, YES)]
    performed: list[Step] = []
    if several:  # whether it is enough counts this time too
        counts += [(hits, hits.value + whole(1))]
        performed = [Branch(active & enough, StepBlock([put((done, YES))]))]
    else:
        counts += [(done, done.value | active if member else active)]
    if lasting:
        long_enough = ~counted.value & (real(hold - EPSILON) <= TIME - since.value)
        holds = StepBlock([
            Branch(met.value, StepBlock(), StepBlock([put((met, YES), (counted, NO), (since, TIME))])),
            Branch(long_enough, StepBlock([put((counted, YES), *counts), *performed])),
            Branch(counted.value, StepBlock(), StepBlock([again])),
        ])  # fmt: skip
    else:
        holds = StepBlock([Branch(met.value, StepBlock(), StepBlock([put((met, YES), *counts), *performed]))])
    update = StepBlock([_asked(condition, holds, StepBlock([put((met, NO))]))])
    kept = [*([since, counted] if lasting else []), *([hits] if several else [])]
    late = met.value & ~counted.value if lasting else NO
    passing = (struck,) if member else (struck, done)
    return ActionSteps(met, struck, done, fair, enough, late, update, (met, struck, done, fair, *kept), passing)


def restarted(name: str, needed: int) -> list[tuple[GraphVariable, Expression]]:
    """What lets an action start anew: its condition has to hold from now on, and so often."""
    met, hits = GraphVariable(f"met {name}", NO), GraphVariable(f"hits {name}", whole(0))
    return [(met, NO), *([(hits, whole(0))] if needed > 1 else [])]


def _asked(condition: list[list[Expression | Put]], holds: StepBlock, fails: StepBlock) -> StepBlock:
    """Ask for a condition part by part, and go on as soon as it is decided."""
    for parts in reversed(condition):
        way = holds
        for part in reversed(parts):
            way = StepBlock([part, way] if isinstance(part, Put) else [Branch(part, way, fails)])
        fails = way
    return fails


@dataclass(frozen=True, eq=False)
class GroupSteps:
    """A Parallel group in the graph: it is done when its members are; variables as of :class:`ActionSteps`."""

    done: GraphVariable
    fresh: GraphVariable
    update: StepBlock

    @property
    def variables(self) -> tuple[GraphVariable, ...]:
        """What is remembered."""
        return self.done, self.fresh

    @property
    def passing(self) -> tuple[GraphVariable, ...]:
        """What is of one tick only."""
        return (self.fresh,)


def group_steps(name: str, members: list[Expression], one_is_enough: bool, active: Expression) -> GroupSteps:
    """A group whose members have been performed as ``members`` say."""
    done, fresh = GraphVariable(f"done {name}", NO), GraphVariable(f"fresh {name}", NO)
    performed = any_of(members) if one_is_enough else all_of(members) if members else NO
    performs = Branch(all_of([active, ~done.value, performed]), StepBlock([put((done, YES), (fresh, YES))]))
    return GroupSteps(done, fresh, StepBlock([performs]))

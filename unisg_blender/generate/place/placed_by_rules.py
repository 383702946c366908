"""Things that a model does not know, placed by rules: a contract with their names, sizes and supports."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ...scene.categories import FLOOR, STRUCTURE
from ...words import thing_table
from ..observe.contract import Contract
from ..observe.support_priors import RESTS, SupportPrior
from ..propose.rule_proposer import RuleProposer
from .placement_record import Placement

NOTE = "placed by rules: the model does not know it"


def by_rules(placement: Placement) -> Placement:
    """The placement with a note that says how it was made."""
    return replace(placement, note="; ".join(note for note in (NOTE, placement.note) if note))


def contract_with(contract: Contract, things: Sequence[str]) -> Contract:
    """A contract that has some things of the table of words beside its own categories."""
    table, priors = thing_table().things, contract.priors
    tops = sorted({
        prior.support for name, found in priors.supports.items() for prior in found
        if prior.contact == RESTS and prior.support not in ("", *STRUCTURE) and name not in STRUCTURE
    })  # fmt: skip
    supports = {
        thing: [
            SupportPrior(name, 1, RESTS, 0.0, "on_top_of")
            for name in (tops if table[thing].place == "top" else [FLOOR])
        ]
        for thing in things
    }
    sizes = {thing: list(table[thing].size) for thing in things}
    rooms = [[*room, *([0] * len(things))] for room in priors.rooms]
    more = replace(priors, supports=priors.supports | supports, sizes=priors.sizes | sizes, rooms=rooms)
    return replace(contract, vocabulary=(*contract.vocabulary, *things), priors=more)


def rules_for(contract: Contract, things: Sequence[str]) -> RuleProposer:
    """What proposes places for the things of a contract that :func:`contract_with` made."""
    number = {name: position for position, name in enumerate(contract.vocabulary)}
    places = {number[thing]: thing_table().things[thing].place for thing in things}
    return RuleProposer(places, number.get("Door", -1))

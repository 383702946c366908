"""Gives the objects that a generator has placed their behaviour, and says so in what it answers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...scene import SceneGraph
from ..results import Placement
from .action_policy import ActionPolicy
from .behaviour_adder import add_behaviour
from .lesson_draft import UidMaker


def with_behaviour(
    graph: SceneGraph,
    placements: Sequence[Placement],
    policy: ActionPolicy,
    make_uid: UidMaker,
    rng: np.random.Generator,
) -> tuple[SceneGraph, list[Placement]]:
    """The scene with actions of the new objects, and the placements with the actions' names and with notes."""
    made = add_behaviour(graph, [item.uid for item in placements if item.uid], policy, make_uid, rng)

    def told(item: Placement) -> Placement:
        """The placement with its actions and notes."""
        notes = [note for note in (item.note, *made.notes.get(item.uid, ())) if note]
        return replace(item, actions=tuple(made.actions.get(item.uid, ())), note="; ".join(notes))

    return made.scene, [told(item) if item.uid else item for item in placements]

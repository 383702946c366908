"""Behaviour: actions and lessons as data, checked, played and rehearsed."""

from __future__ import annotations

from .batch import Batch
from .conditions import CONDITIONS, Condition
from .links import BehaviourLinks, behaviour_links
from .moment import Moment, moment
from .places import Place, action_places, all_actions, operations
from .state import ActionState, Checks, compile_actions, holds, start, step
from .vector import CHANNELS, WIDTH, ActionVectors, action_vector, decode_action, encode_action

__all__ = [
    "CHANNELS", "CONDITIONS", "WIDTH", "ActionState", "ActionVectors", "Batch", "BehaviourLinks", "Checks", "Condition",
    "Moment", "Place", "action_places", "action_vector", "all_actions", "behaviour_links", "compile_actions",
    "decode_action", "encode_action", "holds", "moment", "operations", "start", "step",
]  # fmt: skip

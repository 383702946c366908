"""Behaviour: actions and lessons as data, checked, played and rehearsed."""

from __future__ import annotations

from .links import BehaviourLinks, behaviour_links
from .places import Place, action_places, all_actions, operations
from .vector import CHANNELS, WIDTH, ActionVectors, action_vector, decode_action, encode_action

__all__ = [
    "CHANNELS", "WIDTH", "ActionVectors", "BehaviourLinks", "Place", "action_places", "action_vector", "all_actions",
    "behaviour_links", "decode_action", "encode_action", "operations",
]  # fmt: skip

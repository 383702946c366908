"""Behaviour: actions and lessons as data, checked, played and rehearsed."""

from __future__ import annotations

from .batch import Batch
from .conditions import CONDITIONS, Condition
from .explain import explain
from .links import BehaviourLinks, behaviour_links
from .moment import Moment, moment
from .places import Place, action_places, all_actions, operations
from .player import Event, Lesson, PlayState, begin, play, prepare
from .state import ActionState, Checks, compile_actions, holds, start, step
from .validate import Problem, check_lesson, check_scene
from .vector import CHANNELS, WIDTH, ActionVectors, action_vector, decode_action, encode_action

__all__ = [
    "CHANNELS", "CONDITIONS", "WIDTH", "ActionState", "ActionVectors", "Batch", "BehaviourLinks", "Checks", "Condition",
    "Event", "Lesson", "Moment", "Place", "PlayState", "Problem", "action_places", "action_vector", "all_actions",
    "begin", "behaviour_links", "check_lesson", "check_scene", "compile_actions", "decode_action", "encode_action",
    "explain", "holds", "moment", "operations", "play", "prepare", "start", "step",
]  # fmt: skip

"""Behaviour: actions and lessons as data, checked, played and rehearsed."""

from __future__ import annotations

from .batch import Batch
from .conditions import CONDITIONS, Condition
from .explain import explain
from .links import BehaviourLinks, behaviour_links
from .moment import Moment, moment
from .motion import Input, Motion, Track, moments
from .motion_json import motion_from_json, motion_to_json
from .own_types import add_type, load_types, remove_type
from .places import Place, action_places, all_actions, operations
from .player import Event, Lesson, PlayState, begin, play, prepare
from .recorded import recorded_inputs, recorded_motion, with_events
from .recorder import Recorder, local_matrices
from .rehearse import rehearse
from .state import ActionState, Checks, compile_actions, holds, start, step
from .timeline import Timeline, simulate, timeline_record
from .validate import Problem, check_lesson, check_scene
from .vector import CHANNELS, WIDTH, ActionVectors, action_vector, decode_action, encode_action

__all__ = [
    "CHANNELS", "CONDITIONS", "WIDTH", "ActionState", "ActionVectors", "Batch", "BehaviourLinks", "Checks", "Condition",
    "Event", "Input", "Lesson", "Moment", "Motion", "Place", "PlayState", "Problem", "Recorder", "Timeline", "Track",
    "action_places", "action_vector", "add_type", "all_actions", "begin", "behaviour_links", "check_lesson",
    "check_scene", "compile_actions", "decode_action", "encode_action", "explain", "holds", "load_types",
    "local_matrices", "moment", "moments", "motion_from_json", "motion_to_json", "operations", "play", "prepare",
    "recorded_inputs", "recorded_motion", "rehearse", "remove_type", "simulate", "start", "step", "timeline_record",
    "with_events",
]  # fmt: skip

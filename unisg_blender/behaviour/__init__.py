"""Behaviour: actions and lessons as data, checked, played and rehearsed."""

from __future__ import annotations

from .fulfilment.action_batch import Batch
from .fulfilment.action_state import ActionState, Checks, compile_actions, holds, start, step
from .fulfilment.conditions import CONDITIONS, Condition
from .fulfilment.custom_types import add_type, load_types, remove_type
from .fulfilment.snapshot import Moment, moment
from .lesson.action_places import ActionPlace, action_places, all_actions, operations
from .lesson.action_vector import CHANNELS, WIDTH, ActionVectors, action_vector, decode_action, encode_action
from .lesson.behaviour_links import BehaviourLinks, behaviour_links
from .playing.explanation import explain
from .playing.lesson_validation import Problem, check_lesson, check_scene
from .playing.player import Event, Lesson, PlayState, begin, play, prepare
from .playing.timeline import Timeline, simulate, timeline_record
from .record.motion_script import motion_from_json, motion_to_json
from .record.motion_tracks import Input, Motion, Track, moments
from .record.pose_recorder import PoseRecorder
from .record.recorded_events import recorded_inputs, recorded_motion, with_events
from .rehearsing.rehearsal import rehearse

__all__ = [
    "CHANNELS", "CONDITIONS", "WIDTH", "ActionPlace", "ActionState", "ActionVectors", "Batch", "BehaviourLinks",
    "Checks", "Condition", "Event", "Input", "Lesson", "Moment", "Motion", "PlayState", "PoseRecorder", "Problem",
    "Timeline", "Track", "action_places", "action_vector", "add_type", "all_actions", "begin", "behaviour_links",
    "check_lesson", "check_scene", "compile_actions", "decode_action", "encode_action", "explain", "holds",
    "load_types", "moment", "moments", "motion_from_json", "motion_to_json", "operations", "play", "prepare",
    "recorded_inputs", "recorded_motion", "rehearse", "remove_type", "simulate", "start", "step", "timeline_record",
    "with_events",
]  # fmt: skip

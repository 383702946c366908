"""Why an action was performed, or is not yet: what was measured and what the limit is, in words."""

from __future__ import annotations

import math

import numpy as np

from ...scene.action_data import ActionData
from ...scene.graph import SceneGraph
from ..fulfilment.action_batch import make_batch
from ..fulfilment.conditions import CONDITIONS, in_contact
from ..fulfilment.deviation import away_by
from ..fulfilment.snapshot import Moment


def explain(graph: SceneGraph, action: ActionData, moment: Moment) -> str:
    """One line about an action at a moment, such as "'Scalpel' is 0.4 cm (at most 1 cm) from its place".

    Of several targets or tools, the one that is nearest to performing the action.
    """
    if action.type == "Question":
        right = ", ".join(repr(action.answers[at]) for at in action.correct if at < len(action.answers))
        return f"answered {right}"
    if action.type == "Parallel":
        return f"{action.mode} of {len(action.members)} performed"
    if action.type not in CONDITIONS:
        return f"the condition of {action.type!r} holds"
    batch = make_batch(graph, [action], [0])
    if action.type != "Use" and len(batch.poses.row):
        distance, angle = away_by(batch, moment)
        nearest = int(np.argmax(distance) if action.type == "Remove" else np.argmin(distance))
        return _pose_text(graph.name[batch.poses.row[nearest]], action, float(distance[nearest]), float(angle[nearest]))
    contacts = batch.contacts
    touch = in_contact(batch, moment, np.ones(len(contacts.action), bool))
    if not len(touch):
        return "what it needs is not in the scene"
    pair = int(np.argmax(touch))
    tool, target = graph.name[contacts.tool[pair]], graph.name[contacts.target[pair]]
    return f"{tool!r} {'touches' if touch.any() else 'does not touch'} {target!r}{_limits_text(action)}"


def _pose_text(name: str, action: ActionData, distance: float, angle: float) -> str:
    limits, leaves = action.thresholds, action.type == "Remove"
    parts = []
    if limits.distance is not None:
        word = "more than" if leaves else "at most"
        parts.append(f"{round(100 * distance, 2):g} cm ({word} {100 * limits.distance:.3g} cm)")
    if limits.angle is not None:
        word = "more than" if leaves else "at most"
        parts.append(f"{round(math.degrees(angle), 2):g}° ({word} {math.degrees(limits.angle):.3g}°)")
    return f"{name!r} is {(' or ' if leaves else ' and ').join(parts)} from its place{_limits_text(action)}"


def _limits_text(action: ActionData) -> str:
    limits, text = action.thresholds, ""
    if action.trigger or action.type == "Tool":
        text += ", with the trigger"
    if limits.force:
        text += f", with {limits.force:g} N"
    if limits.hold:
        text += f", for {limits.hold:g} s"
    if limits.hits and limits.hits > 1:
        text += f", {limits.hits} times"
    return text

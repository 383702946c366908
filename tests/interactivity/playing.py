"""The same moments for the player of lessons and for their graph, and what each of them tells."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from unisg_blender.behaviour import begin, play, prepare
from unisg_blender.behaviour.fulfilment.action_batch import Batch
from unisg_blender.behaviour.fulfilment.body_contact import EPSILON, bodies_at
from unisg_blender.behaviour.fulfilment.conditions import CONDITIONS
from unisg_blender.behaviour.fulfilment.deviation import placed
from unisg_blender.behaviour.fulfilment.snapshot import Moment
from unisg_blender.geometry.affine_rows import gather
from unisg_blender.geometry.box_overlap import penetration
from unisg_blender.geometry.y_up import turned_matrices
from unisg_blender.interactivity import LessonGraph
from unisg_blender.interactivity.graph_player import GraphPlayer

EVENTS = {
    "opened": "unisg:started", "done": "unisg:performed", "skipped": "unisg:skipped",
    "out_of_order": "unisg:early", "wrong_answer": "unisg:failed",
}  # fmt: skip

Told = list[tuple[str, int]]
"""Events of one moment: the id, and the node of the lesson's outline."""


def near_by_axes(batch: Batch, moment: Moment, usable: np.ndarray) -> np.ndarray:
    """Contact as graphs tell it: no separating axis parts the boxes by more than the distance."""
    contacts = batch.contacts
    tool = bodies_at(gather(moment.world, contacts.tool), contacts.tool_bounds)
    target = bodies_at(gather(moment.world, contacts.target), contacts.target_bounds)
    near = penetration(tool, target) >= -contacts.distance - EPSILON
    return near & usable & (moment.force[contacts.tool] >= batch.force[contacts.action] - EPSILON)


def use(batch: Batch, moment: Moment) -> np.ndarray:
    pressed = moment.trigger[batch.contacts.tool] | ~batch.trigger[batch.contacts.action]
    return batch.any_of(batch.contacts.action, near_by_axes(batch, moment, pressed))


def tool(batch: Batch, moment: Moment) -> np.ndarray:
    poses, contacts = batch.poses, batch.contacts
    works = placed(batch, moment)[0] & moment.trigger[poses.row]
    works &= moment.force[poses.row] >= batch.force[poses.action] - EPSILON
    posed = batch.any_of(poses.action, np.ones(len(poses.action), bool))
    touched = near_by_axes(batch, moment, moment.trigger[contacts.tool] & ~posed[contacts.action])
    return batch.any_of(poses.action, works) | batch.any_of(contacts.action, touched)


BY_AXES = {**CONDITIONS, "Use": use, "Tool": tool}


def told_by_player(
    compiled: LessonGraph, moments: Iterable[Moment], conditions: Mapping[str, Any] = BY_AXES
) -> list[Told]:
    """What the player tells at each moment."""
    lesson = prepare(compiled.lesson.graph, compiled.lesson.outline.nodes[0], conditions)
    place = {node.uid: number for number, node in enumerate(lesson.outline.nodes)}
    state, told = begin(lesson), []
    for moment in moments:
        state, events = play(lesson, state, moment)
        told.append([(EVENTS[event.kind], place[event.uid]) for event in events])
    return told


def told_by_graph(compiled: LessonGraph, moments: Iterable[Moment]) -> list[Told]:
    """What the graph tells, run by our own player."""
    world: dict[str, np.ndarray] = {}
    player = GraphPlayer(compiled.graph, lambda node: world["now"][node].T.ravel().tolist())
    known = {event["id"] for event in compiled.graph["events"]}
    pressed = np.zeros(len(compiled.lesson.graph), bool)
    force = np.zeros(len(pressed))
    told = []
    for moment in moments:
        world["now"] = turned_matrices(np.asarray(moment.world))
        for row in np.flatnonzero(moment.trigger != pressed).tolist():
            if "unisg:trigger" in known:
                player.send("unisg:trigger", entity=row, pressed=bool(moment.trigger[row]))
        for row in np.flatnonzero(moment.force != force).tolist():
            if "unisg:force" in known:
                player.send("unisg:force", entity=row, newtons=float(moment.force[row]))
        pressed, force = moment.trigger, moment.force
        for uid, given in moment.answers.items():
            tasks = [task for task, action in enumerate(compiled.lesson.checks.actions) if action.uid == uid]
            if tasks:
                player.send("unisg:answer", task=tasks[0], chosen=sum(1 << place for place in set(given)))
        told.append([(event, _node(compiled, values)) for event, values in player.tick(moment.time)])
    return told


def _node(compiled: LessonGraph, values: Mapping[str, int]) -> int:
    return values["node"] if "node" in values else compiled.leaf_of(values["task"])

"""Perform a lesson as an obedient learner would: a motion that fulfils every action in its turn.

This is how one finds out whether a lesson can be played to its end.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...errors import UniSGError
from ..fulfilment.action_batch import Batch, make_batch
from ..fulfilment.custom_types import OWN_GESTURES
from ..fulfilment.deviation import away_by
from ..fulfilment.snapshot import moment
from ..lesson.lesson_progress import OPEN
from ..playing.player import Lesson
from ..record.motion_tracks import Motion
from .gestures import away_goal, place_goal, touch_goals
from .hand import Hand


def rehearse(lesson: Lesson, rate: float = 10.0) -> Motion:
    """A motion in which every action is performed, optional ones too, in the order of the lesson.

    Objects move straight to where they belong, through each other if need be: a proof
    that the lesson can be done, no model of a hand. :func:`~..record.motion_tracks.moments` and
    :func:`~..playing.timeline.simulate` play it.

    Parameters
    ----------
    rate
        Frames per second.

    Raises
    ------
    UniSGError
        If a mandatory action cannot be performed this way; the message names it.
    """
    hand, tried = Hand(lesson, rate), set[int]()
    hand.wait(1 / rate)
    while leaves := [place for place in _open_leaves(hand) if place not in tried]:
        tried.add(leaves[0])
        _perform(hand, int(lesson.task[leaves[0]]))
    if not hand.state.finished:
        stuck = next(place for place in _open_leaves(hand) if lesson.outline.mandatory[place])
        kind = lesson.checks.actions[lesson.task[stuck]].type
        hint = "" if kind in GESTURES or kind in OWN_GESTURES else ": give its type a gesture"
        raise UniSGError(f"{lesson.outline.label(stuck)} ({kind}) is not performed by doing what it asks for{hint}")
    return hand.motion()


def _open_leaves(hand: Hand) -> list[int]:
    return [int(place) for place in np.flatnonzero((hand.state.status == OPEN) & (hand.lesson.task >= 0))]


def _perform(hand: Hand, task: int) -> None:
    """Do what an action asks for; of a group, one member after another until it is enough."""
    action = hand.lesson.checks.actions[task]
    if action.type == "Parallel":
        group = next(each for each in hand.lesson.checks.groups if each.index == task)
        for member in group.members:
            if not hand.state.actions.done[task]:
                _perform(hand, int(member))
    elif action.type == "Question":
        hand.answer(action.uid, action.correct)
        hand.wait(1.0)
    else:
        gesture = GESTURES.get(action.type) or OWN_GESTURES.get(action.type, _place_or_touch)
        gesture(hand, make_batch(hand.lesson.graph, [action], [0]))


def _place(hand: Hand, batch: Batch) -> None:
    """Insert and Remove: the target that is nearest goes to its place, or away from it."""
    if len(batch.poses.row):
        distance, _ = away_by(batch, moment(hand.lesson.graph, 0, hand.world))
        goal = away_goal if batch.actions[0].type == "Remove" else place_goal
        pair = int(np.argmin(distance))
        hand.move(int(batch.poses.row[pair]), goal(batch, pair, hand.world))
        hand.wait(batch.hold[0] + 2 / hand.rate)


def _place_or_touch(hand: Hand, batch: Batch) -> None:
    """What most types of a user's own may ask for."""
    (_place if len(batch.poses.row) else _touch)(hand, batch)


def _work(hand: Hand, batch: Batch) -> None:
    """Tool: the tool goes to its pose, makes its strokes and comes back."""
    if not len(batch.poses.row):
        return _touch(hand, batch)
    row = int(batch.poses.row[0])
    before = hand.world[row]
    hand.move(row, place_goal(batch, 0, hand.world))
    for _ in range(int(batch.hits[0])):
        _stroke(hand, row, batch)
    return hand.move(row, before)


def _touch(hand: Hand, batch: Batch) -> None:
    """Use: the tool comes down on its target as often as asked for, and goes back."""
    contacts = batch.contacts
    if not len(contacts.tool):
        return
    tool, target = int(contacts.tool[0]), int(contacts.target[0])
    distance = float(batch.distance[0]) if np.isfinite(batch.distance[0]) else 0.0
    before = hand.world[tool]
    above, contact = touch_goals(hand.lesson, tool, target, distance, hand.world)
    for _ in range(int(batch.hits[0])):
        hand.move(tool, above)
        hand.move(tool, contact)
        _stroke(hand, tool, batch)
    hand.move(tool, above)
    hand.move(tool, before)


def _stroke(hand: Hand, row: int, batch: Batch) -> None:
    uid = hand.lesson.graph.uid[row]
    hand.press(uid, True, float(batch.force[0]))
    hand.wait(batch.hold[0] + 2 / hand.rate)
    hand.press(uid, False, 0.0)
    hand.wait(1 / hand.rate)


GESTURES: dict[str, Callable[[Hand, Batch], None]] = {"Insert": _place, "Remove": _place, "Use": _touch, "Tool": _work}

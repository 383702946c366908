"""What each type of action asks for, in world space and for all actions of the type at once.

A condition is a function ``condition(batch, moment) -> bool (K,)``: does what the
K actions of the batch ask for hold at this moment? How long and how often it has
to hold (the thresholds ``hold`` and ``hits``) is the same for all types and lives
in :mod:`.action_state`. A type of your own is such a function, given by name::

    def lift(batch, moment):
        return moment.world[batch.target, 2, 3] >= batch.distance

    add_type("Lift", lift)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from ...geometry.affine_rows import gather, some
from .action_batch import Batch
from .body_contact import EPSILON, touching
from .deviation import placed
from .snapshot import Moment

Condition = Callable[[Batch, Moment], NDArray[np.bool_]]
"""Says of K actions which of them hold at a moment, bool (K,)."""


def insert(batch: Batch, moment: Moment) -> NDArray[np.bool_]:
    """A target is at its reference pose: within ``distance`` and ``angle`` (at the limit still is)."""
    return batch.any_of(batch.poses.action, placed(batch, moment)[0])


def remove(batch: Batch, moment: Moment) -> NDArray[np.bool_]:
    """A target has left its reference pose: farther than ``distance`` or turned by more than ``angle``.

    Without a reference pose it has to leave the pose in which the scene has it.
    """
    return batch.any_of(batch.poses.action, placed(batch, moment)[1])


def use(batch: Batch, moment: Moment) -> NDArray[np.bool_]:
    """A tool touches a target (or is within ``distance`` of it), with ``force``, and with its trigger if asked."""
    pressed = moment.trigger[batch.contacts.tool] | ~batch.trigger[batch.contacts.action]
    return batch.any_of(batch.contacts.action, in_contact(batch, moment, pressed))


def tool(batch: Batch, moment: Moment) -> NDArray[np.bool_]:
    """A tool works: at its reference pose, or where there is none in contact with a target; trigger pressed, ``force``.

    The reference is the pose of the *tool*; every stroke of the trigger is a hit.
    """
    poses, contacts = batch.poses, batch.contacts
    works = placed(batch, moment)[0] & moment.trigger[poses.row]
    works &= moment.force[poses.row] >= batch.force[poses.action] - EPSILON
    posed = batch.any_of(poses.action, np.ones(len(poses.action), bool))
    touched = in_contact(batch, moment, moment.trigger[contacts.tool] & ~posed[contacts.action])
    return batch.any_of(poses.action, works) | batch.any_of(contacts.action, touched)


def question(batch: Batch, moment: Moment) -> NDArray[np.bool_]:
    """The right answers, and no others, are given in this moment."""
    result = np.zeros(len(batch.actions), bool)
    for uid, given in moment.answers.items():
        for place in np.flatnonzero(batch.uid == uid):
            result[place] = set(given) == set(batch.actions[place].correct)
    return result


CONDITIONS: Mapping[str, Condition] = {
    "Insert": insert,
    "Remove": remove,
    "Use": use,
    "Tool": tool,
    "Question": question,
}
"""The conditions of the types that come with UniSG. Parallel groups follow their members."""


def in_contact(batch: Batch, moment: Moment, usable: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Which ``usable`` (P,) tools touch their targets with the force asked for; bool (P,). No distance given: 0."""
    contacts = batch.contacts
    result = np.zeros(len(usable), bool)
    tried = np.flatnonzero(usable & (moment.force[contacts.tool] >= batch.force[contacts.action] - EPSILON))
    if len(tried):
        tool, target = (gather(moment.world, rows[tried]) for rows in (contacts.tool, contacts.target))
        bounds = some(contacts.tool_bounds, tried), some(contacts.target_bounds, tried)
        result[tried] = touching(tool, bounds[0], target, bounds[1], contacts.distance[tried])
    return result

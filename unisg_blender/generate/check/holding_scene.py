"""What does not hold is taken out of a scene again, and told."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...scene import SceneGraph
from ...scene.hierarchy import subtree, take
from ..place.placement_record import Placement
from .mesh_check import CUTTING, faults

SPARE = 0.05
"""Metres that stay free on both sides of a person where something new stands beside a way."""


def only_what_holds(
    before: SceneGraph, after: SceneGraph, placements: Sequence[Placement], ways: bool = True
) -> tuple[SceneGraph, list[Placement]]:
    """A scene without the new things that do not hold by :func:`~.mesh_check.faults`, nor what stands on these.

    Without ``ways`` things may cut a place in a room off.

    Returns the scene and the placements, those of what was taken out refused with the reason.
    """
    found = faults(after, before, [item.uid for item in placements if item.uid], spare=SPARE)
    found = {uid: reason for uid, reason in found.items() if ways or reason != CUTTING}
    if not found:
        return after, list(placements)
    gone = np.zeros(len(after), bool)
    for uid in found:
        gone[subtree(after, after.row_of_uid[uid])] = True
    told = []
    for item in placements:
        if item.uid and gone[after.row_of_uid[item.uid]]:
            note = found.get(item.uid, f"{item.support} that was to hold it found no place")
            item = replace(item, name="", uid="", support="", world=None, collision=0.0, note=note)
        told.append(item)
    return take(after, np.flatnonzero(~gone)), told

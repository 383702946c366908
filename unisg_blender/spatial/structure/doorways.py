"""What has to stay free for doors to be used."""

from __future__ import annotations

import numpy as np

from ...geometry.boxes import Boxes
from ...geometry.planar import rotation
from .structure import Room

FREE, ASIDE = 0.4, 0.1
"""Metres before and behind a door that stay free, and at its sides that need not."""

STEP, HEAD = 0.05, 1.8
"""Metres over the floor between which something is in the way of who goes through."""


def doorways(rooms: tuple[Room, ...]) -> Boxes:
    """Upright boxes before the doors of some rooms, world metres."""
    center, half, yaw = [np.zeros((0, 3))], [np.zeros((0, 3))], [np.zeros(0)]
    for room in rooms:
        for door in (opening for opening in room.openings if opening.kind == "door"):
            along = door.stop - door.start
            width = float(np.linalg.norm(along))
            if width > 2 * ASIDE:
                center.append(np.array([[*(door.start + door.stop) / 2, room.floor + (STEP + HEAD) / 2]]))
                half.append(np.array([[width / 2 - ASIDE, FREE, (HEAD - STEP) / 2]]))
                yaw.append(np.arctan2(along[1:], along[:1]))
    turns = rotation(np.concatenate(yaw))
    count = len(turns)
    return Boxes(np.concatenate(center), turns.reshape(count, 3, 3), np.concatenate(half), np.ones(count, bool))

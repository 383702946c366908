"""Actions are of things that are there: without one of them nothing is to be done."""

from __future__ import annotations

import numpy as np
import pytest

from unisg_blender.worlds.behaviour_script import Script
from unisg_blender.worlds.operating_room_world import furnish


def test_inserting_needs_the_thing_and_where_it_goes() -> None:
    script = Script(furnish(0))
    one, other = script.layout.objects[:2]
    for obj, frame in ((None, other), (one, None), (None, None)):
        assert script.insert("put", obj, frame, np.eye(4), 0.1, 10.0) == ""
    assert not script.actions
    uid = script.insert("put", one, other, np.eye(4), 0.1, 10.0)
    ((owner, (action,)),) = script.actions.items()
    assert (owner, action.uid, action.targets, action.frame) == (one.uid, uid, (one.uid,), other.uid)
    assert action.thresholds.angle == pytest.approx(np.radians(10), abs=1e-6)
    assert script.remove("take", None, 0.3) == ""

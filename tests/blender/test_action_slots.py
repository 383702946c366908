"""Objects in an action's slots, and slots that an action does not have."""

from __future__ import annotations

import bpy
import pytest

from tests.blender.helpers import add
from unisg_blender.blender.authoring.authoring import add_action, identity_of, link_objects, unlink_object
from unisg_blender.blender.authoring.stored_behaviour import actions_of
from unisg_blender.errors import UniSGError


def test_what_is_linked_is_unlinked() -> None:
    scene, item, other = bpy.context.scene, add("A"), add("B")
    add_action(bpy.context.scene, item, "Reference")
    link_objects(scene, item, 0, "tools", [other])
    uid = identity_of(scene, other)
    assert actions_of(item)[0].tools == (uid,)
    unlink_object(item, 0, "tools", uid)
    assert actions_of(item)[0].tools == ()


@pytest.mark.parametrize("slot", ["", "type", "names", "x" * 1000])
def test_a_slot_that_is_none_is_refused(slot: str) -> None:
    item = add("A")
    add_action(bpy.context.scene, item, "Reference")
    with pytest.raises(UniSGError, match=r"an action has no .*: it has targets, tools, members and a frame"):
        unlink_object(item, 0, slot, "u")
    assert actions_of(item)[0].type == "Reference"

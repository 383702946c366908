"""The F-curves of objects and pose bones, whatever the version of Blender.

Works on legacy actions (Blender 4.2), slotted actions (4.4 on) and where only
channel bags are left (5.0 on).
"""

from __future__ import annotations

from typing import Any, TypeAlias

import bpy
import numpy as np
from numpy.typing import NDArray

Item: TypeAlias = "bpy.types.Object | bpy.types.PoseBone"
Floats = NDArray[np.float64]


def curves_of(item: Item) -> Any:
    """The collection of F-curves that animates an item, or None."""
    data = item.id_data.animation_data
    if data is None or data.action is None:
        return None
    if not hasattr(data.action, "slots"):
        return data.action.fcurves
    if data.action_slot is None:
        return None
    bags = (strip.channelbag(data.action_slot) for layer in data.action.layers for strip in layer.strips)
    return next((bag.fcurves for bag in bags if bag is not None), None)


def new_curves(item: bpy.types.Object) -> Any:
    """The empty list of F-curves of a new action for an object, whatever the version of Blender."""
    action = bpy.data.actions.new(item.name)
    animation = item.animation_data_create()
    animation.action = action
    if not hasattr(action, "slots"):  # before 4.4, actions have no layers
        return action.fcurves
    slot = action.slots.new(id_type="OBJECT", name=item.name)
    animation.action_slot = slot
    strip = action.layers.new("Layer").strips.new(type="KEYFRAME")
    return strip.channelbag(slot, ensure=True).fcurves


def continuous_signs(quaternions: Floats, before: Floats) -> Floats:
    """Quaternions (F, 4) with the signs that bring each next to the one before it, and the first next to ``before``."""
    inner = (quaternions * np.concatenate([before[None], quaternions[:-1]])).sum(axis=1)
    return quaternions * np.cumprod(np.where(inner < 0, -1.0, 1.0))[:, None]

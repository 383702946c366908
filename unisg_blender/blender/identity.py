"""Write categories and identities onto Blender objects."""

from __future__ import annotations

from collections.abc import Iterable

import bpy

from ..scene.actions import actions_to_json
from ..scene.identity import new_uid, resolve_uids, retarget_copies
from ..scene.properties import ACTIONS, CATEGORY, UID, decode_properties


def assign_category(objects: Iterable[bpy.types.Object], category: str) -> int:
    """Set (or with "" take away) the category of objects, and give them an identity if they have none.

    Linked objects are passed over. Returns the number of objects changed.
    """
    category = category.strip()
    changed = 0
    for item in objects:
        if item.library is not None:
            continue
        if category:
            item[CATEGORY] = category
            ensure_uid(item)
        elif CATEGORY in item:
            del item[CATEGORY]
        else:
            continue
        changed += 1
    return changed


def ensure_uid(item: bpy.types.Object) -> str:
    """The object's stored uid; a new random one is written if it has none."""
    uid = item.get(UID)
    if not isinstance(uid, str) or not uid:
        uid = item[UID] = new_uid()
    return uid


def repair_identities(scene: bpy.types.Scene) -> int:
    """Write down a unique uid for every object of a scene that may be changed.

    A copy gets the uid under which reading already knows it, and its actions
    point to the targets that were copied with it; an object without a uid gets a
    random one. Returns the number of objects that got another uid.
    """
    objects = list(scene.objects)
    names = [item.name_full for item in objects]
    decoded = [decode_properties({key: item[key] for key in (UID, ACTIONS) if key in item}) for item in objects]
    stored = [record.uid for record in decoded]
    resolved = resolve_uids(stored, names)
    actions = retarget_copies(stored, resolved, names, [record.actions for record in decoded])
    repaired = 0
    for item, record, old, uid, own in zip(objects, decoded, stored, resolved, actions, strict=True):
        if item.library is not None or uid == old:
            continue
        item[UID] = uid if old else new_uid()
        if own is not record.actions:
            item[ACTIONS] = actions_to_json(own)
        repaired += 1
    return repaired

"""Write categories and identities onto Blender objects."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import bpy
import numpy as np
from numpy.typing import NDArray

from ...scene.action_data import actions_to_json
from ...scene.copied_behaviour import retarget_properties
from ...scene.identity import new_uid, resolve_uids
from ...scene.lesson_node import lesson_to_json
from ...scene.properties import ACTIONS, CATEGORY, LSA, NAMES, RELATIONS, UID, ObjectProperties, decode_properties
from ...scene.relation import relations_to_json
from ..lookup import stored_uid
from ..read.usd_import import STORED, as_written

KEPT = (*NAMES, *STORED)


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
    uid = stored_uid(item)
    if not uid:
        uid = item[UID] = new_uid()
        item.update_tag()
    return uid


def repair_identities(scene: bpy.types.Scene, *, only_copies: bool = False) -> int:
    """Write down a unique uid for every object of a scene that may be changed.

    A copy gets the uid under which reading already knows it, and its actions,
    lesson and relations point to what was copied with it; an object without a uid
    gets a random one, unless ``only_copies``. Returns the number of objects that got
    another uid.
    """
    objects = list(scene.objects)
    names = [item.name for item in objects]
    decoded = [decode_properties(as_written({key: item[key] for key in KEPT if key in item})) for item in objects]
    stored = [record.uid for record in decoded]
    resolved = resolve_uids(stored, names)
    records = retarget_properties(stored, resolved, names, decoded, lambda: world_matrices_of(objects))
    repaired = 0
    for item, record, old, uid in zip(objects, records, stored, resolved, strict=True):
        if item.library is not None or uid == old or (only_copies and not old):
            continue
        item[UID] = uid if old else new_uid()
        item.update_tag()
        if old:
            _write(item, record)
        repaired += 1
    return repaired


def repair_copies(scene: bpy.types.Scene) -> int:
    """Tell objects that share a uid apart; to be called right after something was copied."""
    stored = [uid for item in scene.objects if isinstance(uid := item.get(UID), str) and uid]
    return repair_identities(scene, only_copies=True) if len(set(stored)) < len(stored) else 0


def world_matrices_of(objects: Sequence[bpy.types.Object]) -> NDArray[np.float64]:
    """World matrices float64 (N, 4, 4) of objects, as Blender has them now."""
    return np.array([item.matrix_world for item in objects], np.float64).reshape(-1, 4, 4)


def _write(item: bpy.types.Object, record: ObjectProperties) -> None:
    if record.actions:
        item[ACTIONS] = actions_to_json(record.actions)
    if record.relations:
        item[RELATIONS] = relations_to_json(record.relations)
    if record.lsa is not None:
        item[LSA] = lesson_to_json(record.lsa)

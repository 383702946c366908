"""Unique identifiers: unique in the scene, stable over saving, copying and renaming."""

from __future__ import annotations

import hashlib
import uuid
from collections.abc import Sequence
from dataclasses import replace

from .action_data import ActionData
from .order import natural_key


def new_uid() -> str:
    """A fresh random uid, 32 hexadecimal digits."""
    return uuid.uuid4().hex


def derived_uid(uid: str, name: str) -> str:
    """The uid of an object that has none of its own: always the same for the same (uid, name)."""
    return hashlib.blake2b(f"{uid}\0{name}".encode("utf-8", "surrogatepass"), digest_size=16).hexdigest()


def resolve_uids(stored: Sequence[str], names: Sequence[str]) -> list[str]:
    """Give every object a uid of its own.

    Among objects that share a stored uid (a duplicate carries its original's),
    the first in natural name order keeps it, every other one has a uid derived
    from (uid, name). An object without one gets a uid derived from its name.

    Parameters
    ----------
    stored
        Uids as found, "" for none.
    names
        Names; if two objects agree in both uid and name, their order decides.
    """
    if not any(stored):
        fresh = [derived_uid("", name) for name in names]
        if len(set(fresh)) == len(fresh):
            return fresh
    owner: dict[str, int] = {}
    for row, uid in enumerate(stored):
        if uid and (uid not in owner or natural_key(names[row]) < natural_key(names[owner[uid]])):
            owner[uid] = row
    taken = set(owner)
    resolved = []
    for row, (uid, name) in enumerate(zip(stored, names, strict=True)):
        if not uid or owner[uid] != row:
            uid = derived_uid(uid, name)
            while uid in taken:  # same uid and same name: count on
                uid = derived_uid(uid, name)
            taken.add(uid)
        resolved.append(uid)
    return resolved


def copies(stored: Sequence[str], resolved: Sequence[str], names: Sequence[str]) -> dict[str, list[str]]:
    """For every stored uid that several objects share: the uids of its copies (original left out), in natural order."""
    found: dict[str, list[tuple[object, str]]] = {}
    if not any(stored):
        return {}
    for old, new, name in zip(stored, resolved, names, strict=True):
        if old and old != new:
            found.setdefault(old, []).append((natural_key(name), new))
    return {old: [new for _, new in sorted(group, key=lambda item: (item[0], item[1]))] for old, group in found.items()}


def retarget_copy(action: ActionData, owner: str, copy_of: dict[str, str]) -> ActionData:
    """The action of a copied object.

    Its own uid is derived from (action uid, owner uid); targets, tools, frame and
    members that were copied together with it (``copy_of``: original uid -> copy's
    uid) are the copies, all others stay.
    """

    def moved(uids: tuple[str, ...]) -> tuple[str, ...]:
        """Uids with those of copies in place of the originals."""
        return tuple(copy_of.get(uid, uid) for uid in uids)

    return replace(
        action,
        uid=derived_uid(action.uid, owner),
        targets=moved(action.targets),
        tools=moved(action.tools),
        members=moved(action.members),
        frame=copy_of.get(action.frame, action.frame),
    )

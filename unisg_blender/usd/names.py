"""Legal, unique USD identifiers; the true name stands beside them as ``displayName``."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

from pxr import Sdf, Tf

LONGEST = 60
_OUTSIDE = re.compile(r"\W")


def legal(name: str) -> str:
    """A USD identifier that looks like ``name``: letters of any script stay, at most 60 characters."""
    if len(name) <= LONGEST and name.isascii() and name.isidentifier():
        return name
    text = _OUTSIDE.sub("_", name[:LONGEST])
    if not text or text[0].isdigit():
        text = "_" + text
    return text if Sdf.Path.IsValidIdentifier(text) else str(Tf.MakeValidIdentifier(text))


def clean(text: str) -> str:
    """The text as USD can store it: no zero characters, no lone surrogates."""
    if text.isascii():
        return text.replace("\0", "") if "\0" in text else text
    return text.replace("\0", "").encode("utf-8", "replace").decode("utf-8")


def true_name(prim: Any, otherwise: str = "") -> str:
    """What a prim is called: its ``displayName``, else ``otherwise``, else its identifier."""
    name = prim.GetMetadata("displayName")
    return str(otherwise or prim.GetName()) if name is None else str(name)


class Identifiers:
    """Hands out identifiers that are unique under one prim."""

    def __init__(self, reserved: Iterable[str] = ()) -> None:
        self._taken = set(reserved)
        self._next: dict[str, int] = {}

    def take(self, name: str) -> str:
        """An identifier for ``name`` that was not handed out before."""
        base = text = legal(name)
        while text in self._taken:
            number = self._next[base] = self._next.get(base, 0) + 1
            text = f"{base}_{number}"
        self._taken.add(text)
        return text

"""Procedural worlds: rooms and stacks made by code, the same seed always giving the same scene."""

from __future__ import annotations

from collections.abc import Callable

from ..scene.graph import SceneGraph
from .operating_room import operating_room

WORLDS: dict[str, Callable[[int], SceneGraph]] = {"operating-room": operating_room}
"""The worlds by name; each makes a scene from a seed."""

__all__ = ["WORLDS", "operating_room"]

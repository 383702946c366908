"""Procedural worlds: rooms and stacks made by code, the same seed always giving the same scene."""

from __future__ import annotations

from collections.abc import Callable

from ..scene.graph import SceneGraph
from .cube_world import cube_pairs, cubes
from .living_room_world import living_room
from .operating_room_world import operating_room

WORLDS: dict[str, Callable[[int], SceneGraph]] = {
    "operating-room": operating_room,
    "living-room": living_room,
    "cubes": cubes,
    "cube-pairs": cube_pairs,
}
"""The worlds by name; each makes a scene from a seed."""

__all__ = ["WORLDS", "cube_pairs", "cubes", "living_room", "operating_room"]

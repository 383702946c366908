"""What a scene is in space: objects, supports, surfaces, the floor plan, relations."""

from __future__ import annotations

from .entity_boxes import oriented_boxes
from .floor_plan import room_outline
from .object_rows import Objects, find_objects
from .objects import SceneObjects, scene_objects
from .relation_tolerances import RelationTolerances
from .relations import KINDS, find_relations, relate
from .supports import Supports, find_supports

__all__ = [
    "KINDS", "Objects", "RelationTolerances", "SceneObjects", "Supports", "find_objects", "find_relations",
    "find_supports", "oriented_boxes", "relate", "room_outline", "scene_objects",
]  # fmt: skip

"""What a scene is in space: objects, supports, surfaces, the floor plan, relations."""

from __future__ import annotations

from .entity_boxes import oriented_boxes
from .floor_plan import room_outline
from .relation_tolerances import RelationTolerances
from .relations import KINDS, find_relations, relate

__all__ = ["KINDS", "RelationTolerances", "find_relations", "oriented_boxes", "relate", "room_outline"]

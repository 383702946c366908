"""The UniSG scenegraph: entities, components, systems and behaviour, as columns of plain arrays."""

from __future__ import annotations

from .actions import ActionData, Thresholds
from .assemble import Columns, assemble, canonical
from .bounds import Boxes, local_bounds, oriented_boxes
from .builder import SceneBuilder
from .entity import Entity
from .graph import TYPES, SceneGraph, Table, table
from .hierarchy import children, compose_world, subtree, take, world_matrices
from .info import info
from .lesson import LessonNode
from .mesh import Material, Mesh, mesh_from_faces
from .relations import Relation
from .systems import run

__all__ = [
    "TYPES", "ActionData", "Boxes", "Columns", "Entity", "LessonNode", "Material", "Mesh", "Relation", "SceneBuilder",
    "SceneGraph", "Table", "Thresholds", "assemble", "canonical", "children", "compose_world", "info", "local_bounds",
    "mesh_from_faces", "oriented_boxes", "run", "subtree", "table", "take", "world_matrices",
]  # fmt: skip

"""The UniSG scenegraph: entities, components, systems and behaviour, as columns of plain arrays."""

from __future__ import annotations

from .action_data import ActionData, Thresholds
from .assembly import Columns, assemble, canonical
from .builder import SceneBuilder
from .categories import STRUCTURE
from .entity import Entity
from .graph import TYPES, SceneGraph, Table, table
from .hierarchy import children, compose_world, local_bounds, subtree, take, world_matrices
from .info_component import info
from .lesson_node import LessonNode
from .mesh import Material, Mesh, mesh_from_faces
from .relation import Relation
from .systems import run

__all__ = [
    "STRUCTURE", "TYPES", "ActionData", "Columns", "Entity", "LessonNode", "Material", "Mesh", "Relation",
    "SceneBuilder", "SceneGraph", "Table", "Thresholds", "assemble", "canonical", "children", "compose_world",
    "info", "local_bounds", "mesh_from_faces", "run", "subtree", "table", "take", "world_matrices",
]  # fmt: skip

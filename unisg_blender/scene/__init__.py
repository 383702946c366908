"""The UniSG scenegraph: entities, components, systems and behaviour, as columns of plain arrays."""

from __future__ import annotations

from .action_data import ActionData, Thresholds
from .assembly import Columns, assemble, canonical
from .augmentation import category_dropout, mesh_jitter, mirrored, pose_noise, quarter_turns, scale_noise
from .builder import SceneBuilder
from .categories import STRUCTURE
from .component_table import Table, entry_table, table
from .frame_range import FrameRange
from .graph import TYPES, Entity, SceneGraph
from .hierarchy import children, local_bounds, local_matrices, placed, subtree, take, world_matrices
from .lesson_node import LessonNode
from .merge import append
from .mesh import Material, Mesh, box_mesh, mesh_from_faces
from .motion_frames import frame_range_of
from .parents import compose_world
from .realize_instances import realize
from .relation import Relation
from .systems import System, run

__all__ = [
    "STRUCTURE",
    "TYPES",
    "ActionData",
    "Columns",
    "Entity",
    "FrameRange",
    "LessonNode",
    "Material",
    "Mesh",
    "Relation",
    "SceneBuilder",
    "SceneGraph",
    "System",
    "Table",
    "Thresholds",
    "append",
    "assemble",
    "box_mesh",
    "canonical",
    "category_dropout",
    "children",
    "compose_world",
    "entry_table",
    "frame_range_of",
    "local_bounds",
    "local_matrices",
    "mesh_from_faces",
    "mesh_jitter",
    "mirrored",
    "placed",
    "pose_noise",
    "quarter_turns",
    "realize",
    "run",
    "scale_noise",
    "subtree",
    "table",
    "take",
    "world_matrices",
]  # fmt: skip

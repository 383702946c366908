# What type checkers see: the names that ``__init__.py`` imports when they are first asked for.
from .blender import read_scene, write_scene
from .dataset import UniSGDataset, open_dataset, to_heterodata, to_scenegraph, write_dataset
from .errors import UniSGError
from .formats import read_scene_file, write_scene_file
from .generate import Generator
from .poses import FORMS, Form, convert
from .scene import ActionData, Entity, LessonNode, Mesh, SceneBuilder, SceneGraph, run
from .spatial import relate
from .worlds import WORLDS

__version__: str
__all__ = [
    "FORMS", "WORLDS", "ActionData", "Entity", "Form", "Generator", "LessonNode", "Mesh", "SceneBuilder", "SceneGraph",
    "UniSGDataset", "UniSGError", "__version__", "convert", "open_dataset", "read_scene", "read_scene_file", "relate",
    "run", "to_heterodata", "to_scenegraph", "write_dataset", "write_scene", "write_scene_file",
]  # fmt: skip

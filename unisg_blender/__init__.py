"""UniSG for Blender: scenegraphs that join geometry, behaviour and graph learning.

Importing this package loads neither Blender (``bpy``) nor ``torch``: each room
imports what it needs when it is opened, and the names below are imported when
they are first asked for.
"""

from __future__ import annotations

from .errors import UniSGError
from .runtime.lazy_names import lazy_names

__version__ = "0.1.0"
__all__ = [
    "FORMS", "WORLDS", "ActionData", "Entity", "Form", "Generator", "LessonNode", "Mesh", "SceneBuilder", "SceneGraph",
    "UniSGDataset", "UniSGError", "__version__", "convert", "open_dataset", "read_scene", "read_scene_file", "relate",
    "run", "to_heterodata", "to_scenegraph", "write_dataset", "write_scene", "write_scene_file",
]  # fmt: skip

_ROOMS = {
    "scene": "ActionData Entity LessonNode Mesh SceneBuilder SceneGraph run",
    "poses": "FORMS Form convert",
    "spatial": "relate",
    "worlds": "WORLDS",
    "blender": "read_scene write_scene",
    "formats": "read_scene_file write_scene_file",
    "dataset": "UniSGDataset open_dataset to_heterodata to_scenegraph write_dataset",
    "generate": "Generator",
}

__getattr__, __dir__ = lazy_names(
    __name__, {name: f".{room}" for room, names in _ROOMS.items() for name in names.split()}
)

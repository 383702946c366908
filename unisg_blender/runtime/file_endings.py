"""Kinds of scene file by the endings of their names."""

from __future__ import annotations

from pathlib import Path

GLTF = (".glb", ".gltf")
BLENDER = (".blend", *GLTF, ".fbx", ".obj")
"""Opened by Blender: its own files, and those that it imports; a glTF file that UniSG wrote is read without it."""

USD = (".usd", ".usda", ".usdc", ".usdz")
JSON = (".json",)

LAYOUT_LINES = (".jsonl", ".jsonl.gz")
"""A layout a line."""

LAYOUTS = (*LAYOUT_LINES, ".json.gz", ".world", ".sdf", ".urdf", ".mjcf", ".xml")
"""Rooms of other programs; which program's is told by what they hold, as with a .json."""

ANYTHING = (*JSON, ".json.gz", ".jsonl", ".xml")
"""What may be a layout or anything else."""

MESHES = (".dae", ".ply", ".stl", ".off", ".3mf")
"""Geometry alone, read without Blender."""

PARTS = (*MESHES, ".glb", ".gltf", ".obj")
"""What a layout's meshes are in, where a folder holds layouts."""

READABLE = (*BLENDER, *USD, *JSON, *LAYOUTS, *MESHES)
SCENE_STATE = ".scenestate.json"
"""Written for SceneEval; read by what it holds."""

MJCF = (".xml", ".mjcf")
"""Written for MuJoCo; an .xml is read by what it holds."""

WRITABLE = (".blend", *JSON, *USD, *GLTF, *MJCF)
NO_FOLDERS = (*WRITABLE, ".png", ".jpg", ".svg", ".pdf", ".html", ".onnx", ".csv", ".txt", ".zip")
"""Endings that nobody gives to a folder on purpose."""


def is_of(path: Path, kinds: tuple[str, ...]) -> bool:
    """Whether a file's name has one of these endings, in whatever case."""
    return path.name.lower().lstrip(".").endswith(kinds)

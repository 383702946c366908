"""Kinds of scene file by the endings of their names."""

from __future__ import annotations

from pathlib import Path

BLENDER = (".blend", ".glb", ".gltf", ".fbx", ".obj")
"""Opened by Blender: its own files, and those that it imports."""

USD = (".usd", ".usda", ".usdc", ".usdz")
JSON = (".json",)
READABLE = (*BLENDER, *USD, *JSON)
WRITABLE = (".blend", *JSON, *USD)


def is_of(path: Path, kinds: tuple[str, ...]) -> bool:
    """Whether a file's name has one of these endings, in whatever case."""
    return path.suffix.lower() in kinds

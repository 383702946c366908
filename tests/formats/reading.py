"""What tests of layouts share: scenes of a file, and where their boxes are in the world."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from unisg_blender.formats.layout_scenes import FoundScene, asset_folder, layout_scenes
from unisg_blender.scene import SceneGraph


def write(path: Path, data: Any) -> Path:
    """A JSON file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(data if isinstance(data, str) else json.dumps(data))
    return path


def found_in(path: Path, assets: Path | None = None) -> list[FoundScene]:
    """The scenes of a file."""
    return list(layout_scenes(path, asset_folder(path, assets)))


def bounds(graph: SceneGraph, name: str) -> np.ndarray:
    """Lowest and highest corner (2, 3) of an entity in the world."""
    row = graph.row(name)
    mesh = graph.meshes[graph.mesh[row]]
    points = mesh.points @ graph.world[row, :3, :3].T + graph.world[row, :3, 3]
    return np.array([points.min(axis=0), points.max(axis=0)])


def relations(graph: SceneGraph) -> set[tuple[str, str, str]]:
    """What the scene says of its entities, by name."""
    name = dict(zip(graph.uid, graph.name, strict=True))
    return {(graph.name[row], kind, name[uid]) for row, kind, uid in graph.entries("relations", "kind", "target")}


def xyz(x: float, y: float, z: float) -> dict[str, float]:
    """A point or angles by name."""
    return {"x": x, "y": y, "z": z}

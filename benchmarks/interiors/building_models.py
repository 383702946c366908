"""Building models (IFC) as scenegraphs, and the spaces that their makers drew; needs ifcopenshell."""

from __future__ import annotations

from pathlib import Path

import ifcopenshell
import ifcopenshell.geom
import numpy as np

from unisg_blender.scene import SceneBuilder, SceneGraph, mesh_from_faces

NOT_BUILT = ("IfcSpace", "IfcOpeningElement", "IfcAnnotation", "IfcGrid", "IfcVirtualElement", "IfcSite")
"""What has a shape and is not there to be touched."""


def read_building(path: Path) -> SceneGraph:
    """All that is built, an entity for each element, in world metres."""
    builder = SceneBuilder(path.stem)
    for element, points, faces in _shapes(path):
        if element.is_a() not in NOT_BUILT:
            name = element.Name or element.is_a()
            builder.add(name, uid=element.GlobalId, mesh=mesh_from_faces(name, points, faces))
    return builder.build()


def spaces_of(path: Path) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """The spaces: name, points (V, 3) in world metres, triangles (F, 3)."""
    return [
        (f"{element.Name or ''} {element.LongName or ''}".strip(), points, faces)
        for element, points, faces in _shapes(path)
        if element.is_a("IfcSpace")
    ]


def _shapes(path: Path):
    model = ifcopenshell.open(str(path))
    settings = ifcopenshell.geom.settings()
    settings.set("use-world-coords", True)
    for shape in ifcopenshell.geom.iterate(settings, model):
        element = model.by_id(shape.id)
        points = np.asarray(shape.geometry.verts, float).reshape(-1, 3)
        faces = np.asarray(shape.geometry.faces, np.int64).reshape(-1, 3)
        if len(faces):
            yield element, points, faces

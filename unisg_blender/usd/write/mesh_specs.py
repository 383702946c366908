"""Meshes and materials as USD prims."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ...scene.mesh import Material, Mesh
from .. import schema
from ..names import Identifiers, clean
from .specs import Types, apply_schema, attribute, custom, define, integers, pairs, points, relationship


def write_materials(scene: Any, materials: Mapping[str, Material]) -> dict[str, Any]:
    """Preview surfaces in a scope under the scene's prim; the path of each material by name."""
    if not materials:
        return {}
    scope = define(scene, schema.MATERIAL_SCOPE, "Scope")
    identifiers = Identifiers()
    return {
        name: _write_material(define(scope, identifiers.take(name), "Material", name), material)
        for name, material in materials.items()
    }


def _write_material(prim: Any, material: Material) -> Any:
    shader = define(prim, "surface", "Shader")
    attribute(shader, "info:id", Types.Token, "UsdPreviewSurface")
    red, green, blue, alpha = (float(value) for value in material.base_color)
    for name, kind, value in (
        ("diffuseColor", Types.Color3f, (red, green, blue)),
        ("opacity", Types.Float, alpha),
        ("metallic", Types.Float, float(material.metallic)),
        ("roughness", Types.Float, float(material.roughness)),
    ):
        attribute(shader, f"inputs:{name}", kind, value, uniform=False)
    output = attribute(shader, "outputs:surface", Types.Token, None, uniform=False)
    surface = attribute(prim, "outputs:surface", Types.Token, None, uniform=False)
    surface.connectionPathList.explicitItems = [output.path]
    return prim.path


def write_mesh(prim: Any, mesh: Mesh, materials: Mapping[str, Any]) -> None:
    """Fill a Mesh prim spec; ``materials`` holds the paths of the materials by name."""
    attribute(prim, "points", Types.Point3fArray, points(mesh.points), uniform=False)
    attribute(prim, "faceVertexCounts", Types.IntArray, integers(np.diff(mesh.offsets)), uniform=False)
    attribute(prim, "faceVertexIndices", Types.IntArray, integers(mesh.corners), uniform=False)
    attribute(prim, "extent", Types.Float3Array, points(mesh.bounds), uniform=False)
    attribute(prim, "subdivisionScheme", Types.Token, "none")
    if mesh.normals is not None:
        values = points(mesh.normals)
        attribute(prim, "normals", Types.Normal3fArray, values, uniform=False, interpolation="faceVarying")
    if mesh.uvs:
        _write_uvs(prim, mesh)
    if len(mesh.edges):
        custom(prim, schema.EDGES, Types.IntArray, integers(mesh.edges.reshape(-1)))
    if mesh.materials:
        _bind_materials(prim, mesh, materials)


def _write_uvs(prim: Any, mesh: Mesh) -> None:
    identifiers = Identifiers(("normals", "displayColor", "displayOpacity"))
    order = []
    for name, values in mesh.uvs.items():
        identifier = identifiers.take(name)
        spec = attribute(
            prim, f"primvars:{identifier}", Types.TexCoord2fArray, pairs(values), uniform=False,
            interpolation="faceVarying",
        )  # fmt: skip
        if identifier != name:
            spec.SetInfo("displayName", clean(name))
        order.append(f"primvars:{identifier}")
    if len(order) > 1:
        prim.SetInfo("propertyOrder", order)


def _bind_materials(prim: Any, mesh: Mesh, materials: Mapping[str, Any]) -> None:
    used = [0] if mesh.material_index is None else np.unique(mesh.material_index).tolist()
    if len(mesh.materials) > 1 or used not in ([0], []) or mesh.materials[0] not in materials:
        custom(prim, schema.MATERIALS, Types.StringArray, [clean(name) for name in mesh.materials])
    if len(used) < 2 and (not used or used[0] == 0):
        _bind(prim, mesh.materials, 0, materials)
        return
    attribute(prim, "subsetFamily:materialBind:familyType", Types.Token, "partition")
    for slot in used:
        subset = define(prim, f"slot_{slot}" if slot >= 0 else f"slot_minus_{-slot}", "GeomSubset")
        attribute(subset, "elementType", Types.Token, "face")
        attribute(subset, "familyName", Types.Token, "materialBind")
        faces = np.flatnonzero(mesh.material_index == slot)
        attribute(subset, "indices", Types.IntArray, integers(faces), uniform=False)
        custom(subset, schema.SLOT, Types.Int, slot)
        _bind(subset, mesh.materials, slot, materials)


def _bind(prim: Any, slots: Sequence[str], slot: int, materials: Mapping[str, Any]) -> None:
    path = materials.get(slots[slot]) if 0 <= slot < len(slots) else None
    if path is not None:
        apply_schema(prim, "MaterialBindingAPI")
        relationship(prim, "material:binding", [path], is_custom=False)

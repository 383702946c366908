"""Materials by name, with the colour, metallic and roughness of a preview surface."""

from __future__ import annotations

from collections.abc import Iterable

import bpy

from ..scene.mesh import Material

PLAIN_NODES = {"BSDF_PRINCIPLED", "OUTPUT_MATERIAL", "FRAME", "REROUTE"}
UNUSED = {
    "IOR": 1.5,
    "Diffuse Roughness": 0.0,
    "Subsurface Weight": 0.0,
    "Specular IOR Level": 0.5,
    "Anisotropic": 0.0,
    "Transmission Weight": 0.0,
    "Coat Weight": 0.0,
    "Sheen Weight": 0.0,
    "Emission Strength": 0.0,
    "Thin Film Thickness": 0.0,
}
"""Inputs of the Principled BSDF that a preview surface has no place for, at the values at which they do nothing."""

STARTUP_IOR = 1.45
"""That of the material in Blender's startup file, which was made when this was the default."""


def read_material(material: bpy.types.Material) -> Material:
    """The surface's Principled BSDF if it has one, else the viewport colour."""
    shader = _principled(material)
    if shader is None:
        return Material(material.name, tuple(material.diffuse_color), material.metallic, material.roughness)
    color = (*tuple(shader.inputs["Base Color"].default_value)[:3], shader.inputs["Alpha"].default_value)
    if shader.inputs["Base Color"].is_linked:  # a texture: the viewport colour is the best single value
        color = tuple(material.diffuse_color)
    return Material(
        material.name, color, shader.inputs["Metallic"].default_value, shader.inputs["Roughness"].default_value
    )


def _principled(material: bpy.types.Material) -> bpy.types.Node | None:
    if material.node_tree is None:
        return None
    return next((node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED"), None)


def surface_inputs(material: bpy.types.Material) -> list[str]:
    """Names of what the surface's Principled BSDF is set to beyond colour, metallic and roughness."""
    shader = _principled(material)
    if shader is None:
        return []
    plain = (
        (name, shader.inputs[name].default_value, value) for name, value in UNUSED.items() if name in shader.inputs
    )
    changed = [name for name, value, unused in plain if abs(value - unused) > 1e-6]
    if "IOR" in changed and abs(shader.inputs["IOR"].default_value - STARTUP_IOR) < 1e-6:
        changed.remove("IOR")
    return changed


def write_material(material: Material) -> bpy.types.Material:
    """Blender's material of that name if its values are the same, else a new one."""
    found = bpy.data.materials.get(material.name)
    if found is not None and _same(read_material(found), material):
        return found
    made = bpy.data.materials.new(material.name)
    if made.node_tree is None:
        made.use_nodes = True
    made.diffuse_color = material.base_color
    made.metallic, made.roughness = material.metallic, material.roughness
    shader = _principled(made)
    if shader is not None:
        shader.inputs["Base Color"].default_value = (*material.base_color[:3], 1.0)
        shader.inputs["Alpha"].default_value = material.base_color[3]
        shader.inputs["Metallic"].default_value = material.metallic
        shader.inputs["Roughness"].default_value = material.roughness
    return made


def write_materials(materials: Iterable[Material]) -> dict[str, bpy.types.Material]:
    """Blender's materials under the scenegraph's names."""
    return {material.name: write_material(material) for material in materials}


def _same(first: Material, second: Material) -> bool:
    values = zip(
        (*first.base_color, first.metallic, first.roughness),
        (*second.base_color, second.metallic, second.roughness),
        strict=True,
    )
    return all(abs(a - b) <= 1e-6 for a, b in values)

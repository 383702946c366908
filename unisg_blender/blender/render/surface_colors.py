"""The colours that materials have for a moment, while a picture is made: those that their shaders give."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import bpy

from ..materials import read_material

PLAIN = (0.8, 0.8, 0.8, 1.0)
"""What Blender gives a material as its colour in the viewport, for the shader's to be taken."""


@contextmanager
def shader_colors(items: Sequence[bpy.types.Object]) -> Iterator[None]:
    """Materials of some objects with the colour, or the image, of their shader in the viewport; restored afterwards."""
    used = {slot.material.name: slot.material for item in items for slot in item.material_slots if slot.material}
    colors = {name: tuple(material.diffuse_color) for name, material in used.items()}
    active = {name: material.node_tree.nodes.active for name, material in used.items() if material.node_tree}
    for material in used.values():
        if all(abs(a - b) < 1e-4 for a, b in zip(material.diffuse_color, PLAIN, strict=True)):
            material.diffuse_color = read_material(material).base_color
        image = _base_image(material)
        if image is not None:
            material.node_tree.nodes.active = image
    try:
        yield
    finally:
        for name, material in used.items():
            material.diffuse_color = colors[name]
            if name in active:
                material.node_tree.nodes.active = active[name]


def _base_image(material: bpy.types.Material) -> bpy.types.Node | None:
    """The image that gives a material its colour, None if there is none."""
    nodes = material.node_tree.nodes if material.node_tree else ()
    for shader in (node for node in nodes if node.type == "BSDF_PRINCIPLED"):
        for link in shader.inputs["Base Color"].links:
            if link.from_node.type == "TEX_IMAGE" and link.from_node.image is not None:
                return link.from_node
    return None

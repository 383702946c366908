"""Materials: the colour that a preview surface shows."""

from __future__ import annotations

from typing import Any

from pxr import UsdShade

from ...scene.mesh import Material


def read_material(name: str, material: Any) -> Material:
    """A material from its preview surface, or from what other surfaces call their base colour."""
    shader = material.ComputeSurfaceSource()[0]
    if not shader:
        return Material(name)
    color = _first(shader, ("diffuseColor", "base_color", "baseColor", "diffuse_color_constant"))
    opacity = _first(shader, ("opacity",))
    metallic = _first(shader, ("metallic", "base_metalness", "metalness"))
    roughness = _first(shader, ("roughness", "specular_roughness"))
    red, green, blue = (0.8, 0.8, 0.8) if color is None else (float(part) for part in color)
    return Material(
        name,
        (red, green, blue, 1.0 if not isinstance(opacity, float) else opacity),
        metallic if isinstance(metallic, float) else 0.0,
        roughness if isinstance(roughness, float) else 0.5,
    )


def _first(shader: Any, names: tuple[str, ...]) -> Any:
    """The plain value of the first of some inputs that has one; values that come from textures are none."""
    for name in names:
        entry = shader.GetInput(name)
        if not entry:
            continue
        sources = UsdShade.Utils.GetValueProducingAttributes(entry)
        if sources and UsdShade.Utils.GetType(sources[0].GetName()) == UsdShade.AttributeType.Output:
            return None
        value = sources[0].Get() if sources else None
        if value is not None:
            return value
    return None

"""The materials of the worlds, by name: linear colours."""

from __future__ import annotations

from collections.abc import Iterable

from ...scene.mesh import Material, Mesh

_COLORS = {
    "black": (0.02, 0.02, 0.025),
    "screen": (0.02, 0.10, 0.16),
    "trace": (0.10, 0.80, 0.25),
    "dark": (0.08, 0.09, 0.10),
    "grey": (0.35, 0.37, 0.39),
    "white": (0.85, 0.86, 0.86),
    "cream": (0.76, 0.72, 0.60),
    "steel": (0.55, 0.58, 0.62),
    "chrome": (0.68, 0.72, 0.76),
    "brass": (0.60, 0.42, 0.14),
    "linoleum": (0.36, 0.52, 0.50),
    "parquet": (0.42, 0.26, 0.13),
    "plaster": (0.80, 0.81, 0.76),
    "tile": (0.62, 0.74, 0.74),
    "door": (0.45, 0.55, 0.60),
    "glass": (0.55, 0.72, 0.80),
    "drape": (0.05, 0.28, 0.33),
    "drape_light": (0.16, 0.45, 0.52),
    "mattress": (0.03, 0.04, 0.05),
    "skin": (0.72, 0.45, 0.34),
    "iodine": (0.55, 0.24, 0.06),
    "gauze": (0.88, 0.88, 0.84),
    "rubber": (0.05, 0.05, 0.05),
    "clear": (0.70, 0.80, 0.84),
    "teal": (0.05, 0.35, 0.38),
    "blue": (0.05, 0.15, 0.45),
    "red": (0.60, 0.04, 0.04),
    "yellow": (0.80, 0.58, 0.04),
    "green": (0.08, 0.32, 0.10),
    "titanium": (0.42, 0.44, 0.50),
    "plastic": (0.86, 0.87, 0.88),
    "light": (0.95, 0.95, 0.80),
    "oak": (0.40, 0.23, 0.10),
    "walnut": (0.16, 0.08, 0.04),
    "birch": (0.66, 0.50, 0.32),
    "leather": (0.22, 0.10, 0.05),
    "fabric": (0.24, 0.28, 0.34),
    "fabric_warm": (0.52, 0.30, 0.20),
    "linen": (0.70, 0.66, 0.56),
    "wool": (0.46, 0.12, 0.10),
    "wool_blue": (0.10, 0.18, 0.34),
    "leaf": (0.06, 0.28, 0.06),
    "terracotta": (0.50, 0.20, 0.10),
    "porcelain": (0.88, 0.88, 0.90),
    "canvas": (0.30, 0.46, 0.58),
    "paper": (0.82, 0.80, 0.72),
}
_METALS = {"steel", "chrome", "brass", "titanium"}

MATERIALS = {
    name: Material(name, (*color, 1.0), 0.9 if name in _METALS else 0.0, 0.3 if name in _METALS else 0.6)
    for name, color in _COLORS.items()
}
"""All materials that the worlds' meshes may use."""


def used_by(meshes: Iterable[Mesh]) -> dict[str, Material]:
    """The materials in the slots of some meshes, sorted by name."""
    return {name: MATERIALS[name] for name in sorted({slot for mesh in meshes for slot in mesh.materials})}

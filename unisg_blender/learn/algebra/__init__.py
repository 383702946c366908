"""Layers of networks that commute with motions: multivectors of PGA as tensors. Needs torch."""

from __future__ import annotations

from .embedded_elements import (
    embed_direction,
    embed_frame,
    embed_motor,
    embed_plane,
    embed_point,
    extract_direction,
    extract_motor,
    extract_plane,
    extract_point,
)
from .equivariant_layers import (
    EquivariantLinear,
    GatedNonlinearity,
    GeometricBilinear,
    InvariantAttention,
    MultivectorNorm,
)
from .motion_block import MotionBlock
from .pga_products import geometric_product, inner_product, join, moved, reverse
from .symmetry_maps import SYMMETRIES, commuting_maps, invariant_elements, invariant_parts

__all__ = [
    "SYMMETRIES", "EquivariantLinear", "GatedNonlinearity", "GeometricBilinear", "InvariantAttention", "MotionBlock",
    "MultivectorNorm", "commuting_maps", "embed_direction", "embed_frame", "embed_motor", "embed_plane", "embed_point",
    "extract_direction", "extract_motor", "extract_plane", "extract_point", "geometric_product", "inner_product",
    "invariant_elements", "invariant_parts", "join", "moved", "reverse",
]  # fmt: skip

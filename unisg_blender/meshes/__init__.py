"""The mesh component: surface samples, the AtlasNet feature, and meshes back from features and points."""

from __future__ import annotations

from .decode import decode_cloud, decode_mesh
from .feature import AtlasNetEncoder, MeshFeature
from .reconstruct import reconstruct
from .sampling import SurfaceSamples, sample_surface

__all__ = [
    "AtlasNetEncoder", "MeshFeature", "SurfaceSamples", "decode_cloud", "decode_mesh", "reconstruct", "sample_surface",
]  # fmt: skip

"""The mesh component: surface samples, the AtlasNet feature, and meshes back from features and points."""

from __future__ import annotations

from .decode import decode_cloud, decode_mesh, decode_oriented_cloud
from .sampling import SurfaceSamples, sample_surface
from .shape_feature import AtlasNetEncoder, MeshFeature
from .surface_reconstruction import reconstruct

__all__ = [
    "AtlasNetEncoder", "MeshFeature", "SurfaceSamples", "decode_cloud", "decode_mesh", "decode_oriented_cloud",
    "reconstruct", "sample_surface",
]  # fmt: skip

"""The nearest assets of a library by mesh feature."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError
from ..geometry.arrays import Floats
from ..scene.mesh import Mesh
from .atlasnet_sessions import FEATURE_WIDTH
from .mesh_files import mesh_paths, read_mesh_file
from .normalise import normalise, size_channels
from .shape_feature import POINTS, AtlasNetEncoder, cloud, default_encoder

SIZE_WEIGHT = 0.25
"""How much a factor of e in size counts, in units of the mean distance between two shapes of the library."""


@dataclass(frozen=True)
class Match:
    """An asset of the library: its place there, its name, and how far it is (0: the same shape and size)."""

    place: int
    name: str
    distance: float


@dataclass(frozen=True, eq=False)
class MeshLibrary:
    """Assets to choose from.

    ``names`` of the assets (the paths of their files, for a folder); ``vectors``
    float32 (N, 1024) their mesh features; ``sizes`` float64 (N, 3) in metres.
    """

    names: tuple[str, ...]
    vectors: NDArray[np.float32]
    sizes: Floats

    def nearest(
        self, mesh: Mesh, count: int = 5, *, use_size: bool = True, encoder: AtlasNetEncoder | None = None
    ) -> list[Match]:
        """The assets most like a mesh, nearest first.

        The mesh is compared in four quarter turns about the vertical axis, of which
        the nearest counts.

        Raises
        ------
        UniSGError
            If the library is empty or the mesh has no points.
        """
        if not len(self.names):
            raise UniSGError("the library holds no meshes to compare with")
        queries = quarter_turn_features(mesh, encoder or default_encoder())
        apart = np.linalg.norm(self.vectors[None] - queries[:, None], axis=2).min(axis=0) / self._spread
        if use_size:
            own = size_channels((mesh.bounds[1] - mesh.bounds[0])[None])
            apart = np.hypot(apart, SIZE_WEIGHT * np.linalg.norm(size_channels(self.sizes) - own, axis=1))
        order = np.argsort(apart, kind="stable")[:count]
        return [Match(int(place), self.names[place], float(apart[place])) for place in order]

    @property
    def _spread(self) -> float:
        """Mean distance of the features from their mean, 1 for a single asset."""
        return float(np.linalg.norm(self.vectors - self.vectors.mean(axis=0), axis=1).mean()) or 1.0


def quarter_turn_features(mesh: Mesh, encoder: AtlasNetEncoder) -> NDArray[np.float32]:
    """Features float32 (4, 1024) of a mesh turned by 0, 90, 180 and 270 degrees about z."""
    points, _ = normalise(cloud(mesh, POINTS))
    x, y, z = points.T
    return encoder.encode_clouds([np.stack(turn, axis=1) for turn in ((x, y, z), (-y, x, z), (-x, -y, z), (y, -x, z))])


def mesh_library(names: Sequence[str], meshes: Sequence[Mesh], encoder: AtlasNetEncoder | None = None) -> MeshLibrary:
    """A library of meshes in metres; those without points are left out."""
    kept = [k for k, mesh in enumerate(meshes) if np.isfinite(mesh.points).all(axis=1).any()]
    features = (encoder or default_encoder()).encode([meshes[k] for k in kept])
    vectors = np.array([feature.vector for feature in features], np.float32).reshape(len(kept), FEATURE_WIDTH)
    sizes = np.array([np.ptp(meshes[k].bounds, axis=0) for k in kept]).reshape(-1, 3)
    return MeshLibrary(tuple(names[k] for k in kept), vectors, sizes)


def folder_library(
    folder: str | Path, encoder: AtlasNetEncoder | None = None, skipped: Callable[[str], None] = lambda reason: None
) -> MeshLibrary:
    """A library of all mesh files under a folder; files that cannot be read are told to ``skipped``.

    Raises
    ------
    UniSGError
        If the folder does not exist or has no mesh file that can be read.
    """
    names, meshes = [], []
    for path in mesh_paths(folder):
        try:
            meshes.append(read_mesh_file(path))
            names.append(str(path))
        except UniSGError as error:
            skipped(str(error))
    if not meshes:
        raise UniSGError(f"{folder}: no mesh files that can be read")
    return mesh_library(names, meshes, encoder)

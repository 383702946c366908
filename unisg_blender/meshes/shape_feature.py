"""The 1024-wide AtlasNet feature of meshes."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError
from ..pretrained import FOLDER
from ..scene.mesh import Mesh
from .atlasnet_sessions import ENCODER_FILE, FEATURE_WIDTH, load_network
from .normalise import UnitPlacement, normalise
from .sampling import NoSurfaceError, sample_surface

POINTS = 1024
BATCH = 16
"""Meshes encoded at once; more gain nothing and need memory."""


@dataclass(frozen=True, eq=False)
class MeshFeature:
    """``vector`` float32 (1024,): the normalised shape; ``placement``: where and how big it is in its own frame."""

    vector: NDArray[np.float32]
    placement: UnitPlacement


class AtlasNetEncoder:
    """Gives the features of meshes; each geometry is encoded once, however many meshes share it.

    Calling the encoder with one mesh gives its feature vector, which is what a
    dataset wants; a mesh without any point then has the zero vector.

    Parameters
    ----------
    path
        An encoder made by ``unisg train meshes``; the shipped one when omitted.
    seed
        Seed of the surface samples.
    """

    width = FEATURE_WIDTH

    def __init__(self, path: str | Path | None = None, seed: int = 0) -> None:
        self.path = FOLDER / ENCODER_FILE if path is None else Path(path)
        self.seed = seed
        self._known: dict[str, MeshFeature] = {}

    def __call__(self, mesh: Mesh) -> NDArray[np.float32]:
        """The feature (1024,) of one mesh."""
        if not np.isfinite(mesh.points).all(axis=1).any():
            return np.zeros(FEATURE_WIDTH, np.float32)
        return self.encode([mesh])[0].vector

    def encode(self, meshes: Sequence[Mesh]) -> list[MeshFeature]:
        """The features of meshes, in their order.

        Raises
        ------
        UniSGError
            If a mesh has no finite point, or the model file cannot be used.
        """
        new = {mesh.checksum: mesh for mesh in meshes if mesh.checksum not in self._known}
        clouds = [normalise(cloud(mesh, POINTS, self.seed)) for mesh in new.values()]
        vectors = self.encode_clouds([points for points, _ in clouds])
        for key, vector, (_, placement) in zip(new, vectors, clouds, strict=True):
            self._known[key] = MeshFeature(vector, placement)
        return [self._known[mesh.checksum] for mesh in meshes]

    def encode_clouds(self, clouds: Sequence[NDArray[np.floating]]) -> NDArray[np.float32]:
        """Features float32 (B, 1024) of clouds (n, 3) in the unit sphere, all with the same number of points."""
        if not len(clouds):
            return np.zeros((0, FEATURE_WIDTH), np.float32)
        network = load_network(self.path)
        batches = [np.stack(clouds[start : start + BATCH]) for start in range(0, len(clouds), BATCH)]
        return np.concatenate([network.run(points=batch.astype(np.float32))[0] for batch in batches])


def cloud(mesh: Mesh, count: int, seed: int = 0) -> NDArray[np.float32]:
    """float32 (count, 3): blue-noise points of the surface, or of the points where a mesh has no surface.

    A mesh without surface (a point cloud, a wire, faces of no area) gives random
    ones of its points, each repeated if they are fewer than asked for.

    Raises
    ------
    UniSGError
        If the mesh has no finite point.
    """
    with suppress(NoSurfaceError):
        return sample_surface(mesh, count, seed).points
    finite = mesh.points[np.isfinite(mesh.points).all(axis=1)]
    if not len(finite):
        raise UniSGError(f"mesh {mesh.name!r} has no points: there is nothing to encode")
    chosen = np.random.default_rng(seed).permutation(max(len(finite), count))[:count] % len(finite)
    return finite[chosen]


@lru_cache(maxsize=1)
def default_encoder() -> AtlasNetEncoder:
    """The shipped encoder, with all that it has encoded in this process."""
    return AtlasNetEncoder()


def atlasnet_feature(mesh: Mesh) -> NDArray[np.float32]:
    """The feature (1024,) of a mesh by the shipped encoder: ``unisg export --mesh-features atlasnet``."""
    return default_encoder()(mesh)

"""Point clouds and closed meshes from AtlasNet features."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..scene.mesh import Mesh, mesh_from_faces
from .feature import MeshFeature
from .networks import DECODER_FILE, PRETRAINED, load_network
from .sphere import fibonacci_sphere, sphere_template

FACES = 5000


def decode_cloud(
    features: Sequence[MeshFeature], count: int = 2500, path: str | Path | None = None
) -> NDArray[np.float64]:
    """Points (B, count, 3) of the shapes' surfaces, each in the frame and unit of its own mesh.

    ``path`` is a decoder made by ``unisg train meshes``; the shipped one when omitted.
    """
    unit = decode_unit(np.stack([feature.vector for feature in features]), fibonacci_sphere(count), path)
    return np.stack([feature.placement.restore(points) for feature, points in zip(features, unit, strict=True)])


def decode_mesh(
    feature: MeshFeature, faces: int = FACES, path: str | Path | None = None, name: str = "Decoded"
) -> Mesh:
    """A closed triangle mesh: the decoder's image of a triangulated sphere, oriented outwards.

    Parameters
    ----------
    feature
        Shape and placement; the mesh is in the frame and unit of the placement.
    faces
        Number of triangles, at least 4; an odd number becomes the next even one.
    path
        A decoder; the shipped one when omitted.
    name
        Name of the mesh.

    Raises
    ------
    UniSGError
        If ``faces`` is below 4 or the decoder cannot be used.
    """
    sphere, triangles = sphere_template(faces)
    points = decode_unit(feature.vector[None], sphere, path)[0]
    if signed_volume(points, triangles) < 0:
        triangles = triangles[:, ::-1]
    return mesh_from_faces(name, feature.placement.restore(points), triangles)


def decode_unit(
    vectors: NDArray[np.floating], sphere: NDArray[np.floating], path: str | Path | None = None
) -> NDArray[np.float32]:
    """Where points of the sphere (m, 3) go for features (B, 1024): (B, m, 3), of normalised size."""
    session = load_network(Path(path) if path is not None else PRETRAINED / DECODER_FILE)
    return session.run(None, {"feature": vectors.astype(np.float32), "sphere": sphere.astype(np.float32)})[0]


def signed_volume(points: NDArray[np.floating], triangles: NDArray[np.integer]) -> float:
    """Volume inside closed triangles (T, 3), negative if they face inwards."""
    a, b, c = points[triangles].astype(np.float64).swapaxes(0, 1)
    return float(np.einsum("tk,tk->", a, np.cross(b, c)) / 6)

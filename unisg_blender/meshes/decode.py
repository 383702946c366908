"""Point clouds and closed meshes from AtlasNet features."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError
from ..geometry.arrays import Floats, Ints
from ..pretrained import FOLDER
from ..runtime.onnx_session import OnnxModel, damaged
from ..scene.mesh import Mesh, mesh_from_faces
from .atlasnet_sessions import DECODER_FILE, load_network
from .shape_feature import MeshFeature
from .sphere import box_template, fibonacci_sphere, sphere_template
from .triangulate import area_vectors

MOST_PATCHES = 1024
FACES = 5000
COARSE = 48
"""Faces of each patch when the patches are measured."""
FEWEST_POINTS = 4
"""Points of a patch in a cloud at least, for which there are triangles."""
FEWEST = 12
"""Faces of a patch at least: patches for which there are too few faces are left out, the smallest first."""


def decode_cloud(features: Sequence[MeshFeature], count: int = 2500, path: str | Path | None = None) -> Floats:
    """Points (B, count, 3) of the shapes' surfaces, each in the frame and unit of its own mesh.

    ``path`` is a decoder made by ``unisg train meshes``; the shipped one when omitted.
    """
    return np.stack([feature.placement.restore(_unit_cloud(feature.vector, count, path)[0]) for feature in features])


def decode_oriented_cloud(
    features: Sequence[MeshFeature], count: int = 2500, path: str | Path | None = None
) -> tuple[Floats, Floats]:
    """The points of :func:`decode_cloud`, and normals (B, count, 3) of length 1 that point out of the patches.

    ``reconstruct(points[0], normals[0])`` makes a mesh of them: the paper's chain of feature, cloud, triangulated mesh.
    A point's normal is that of the triangles around it in its patch.

    Raises
    ------
    UniSGError
        If ``count`` is below 4 or the decoder cannot be used.
    """
    if count < 4:
        raise UniSGError(f"a cloud with normals needs 4 points or more, not {count}")
    points, normals = [], []
    for feature in features:
        cloud, counts = _unit_cloud(feature.vector, count, path)
        parts = np.split(cloud.astype(np.float64), np.cumsum(counts)[:-1])
        points.append(feature.placement.restore(cloud))
        normals.append(np.concatenate([patch_normals(part) for part in parts if len(part)]))
    return np.stack(points), np.stack(normals)


def patch_normals(points: Floats) -> Floats:
    """Normals (n, 3), outwards, of the images (n, 3) of a sphere's even points, n >= 4."""
    triangles = sphere_template(2 * len(points) - 4)[1]
    areas = area_vectors(points, triangles) * (1 if signed_volume(points, triangles) >= 0 else -1)
    normals = np.zeros_like(points)
    for corner in range(3):
        np.add.at(normals, triangles[:, corner], areas)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    flat = length[:, 0] <= 1e-12 * np.ptp(points, axis=0).max() ** 2  # folded: away from the patch's middle
    normals[flat] = points[flat] - points.mean(axis=0) + 1e-12
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def decode_mesh(
    feature: MeshFeature, faces: int = FACES, path: str | Path | None = None, name: str = "Decoded"
) -> Mesh:
    """A closed triangle mesh: the decoder's images of triangulated spheres, each oriented outwards.

    Parameters
    ----------
    feature
        Shape and placement; the mesh is in the frame and unit of the placement.
    faces
        Number of triangles, at least 4; an odd number becomes the next even one.
        The patches share them by area.
    path
        A decoder; the shipped one when omitted.
    name
        Name of the mesh.

    Raises
    ------
    UniSGError
        If ``faces`` is below 4 or the decoder cannot be used.
    """
    points, triangles = decode_unit(feature.vector, faces, path)
    return mesh_from_faces(name, feature.placement.restore(points), triangles)


def decode_unit(
    vector: NDArray[np.floating], faces: int = FACES, path: str | Path | None = None
) -> tuple[NDArray[np.float32], Ints]:
    """Points (V, 3), of normalised size, and triangles (faces, 3) of the mesh for one feature (1024,)."""
    if faces < 4:
        raise UniSGError(f"a closed mesh needs 4 faces or more, not {faces}")
    areas = patch_areas(vector, path)
    used = np.sort(np.argsort(-areas, kind="stable")[: max(faces // (2 * FEWEST), 1)])
    half = allot((faces + 1) // 2, areas[used], min(FEWEST, faces) // 2)
    return _patches(vector, used, [int(2 * count) for count in half], path)


def patch_areas(vector: NDArray[np.floating], path: str | Path | None = None) -> Floats:
    """Surface (P,) of each patch that a feature (1024,) decodes to, in units of the unit sphere."""
    decoder = _decoder(path)
    count = decoder.metadata.get("patches")
    if not isinstance(count, int) or not 0 < count <= MOST_PATCHES:
        raise damaged(decoder.path)
    patches = np.arange(count)
    points, triangles = _patches(vector, patches, [COARSE] * len(patches), path)
    return np.linalg.norm(area_vectors(points, triangles), axis=1).reshape(len(patches), COARSE).sum(axis=1) / 2


def allot(total: int, weights: NDArray[np.floating], least: int) -> Ints:
    """Share out ``total`` objects by weight, exactly, ``least`` to each at least; int64, as many as weights."""
    spare = total - least * len(weights)
    bounds = np.round(np.cumsum(weights) / max(weights.sum(), 1e-300) * spare).astype(np.int64)
    bounds[-1] = spare
    return least + np.diff(bounds, prepend=0)


def signed_volume(points: NDArray[np.floating], triangles: NDArray[np.integer]) -> float:
    """Volume inside closed triangles (T, 3), negative if they face inwards."""
    a, b, c = points[triangles].astype(np.float64).swapaxes(0, 1)
    return float(np.einsum("tk,tk->", a, np.cross(b, c)) / 6)


def _unit_cloud(vector: NDArray[np.floating], count: int, path: str | Path | None) -> tuple[NDArray[np.float32], Ints]:
    """Points (count, 3) by patch, and how many each patch has; one too small for four has none."""
    areas = patch_areas(vector, path)
    shared = allot(count, areas, 0)
    counts = np.where(shared < FEWEST_POINTS, 0, shared)
    counts[np.argmax(areas)] += count - counts.sum()
    sphere = np.concatenate([fibonacci_sphere(int(own)) for own in counts])
    return _decoded(vector, sphere, np.repeat(np.arange(len(counts)), counts), path), counts


def _patches(
    vector: NDArray[np.floating], patches: NDArray[np.integer], faces: Sequence[int], path: str | Path | None
) -> tuple[NDArray[np.float32], Ints]:
    """Points and triangles of the given patches, in their order, each turned outwards."""
    templates = [box_template(count) for count in faces]
    sizes = [len(sphere) for sphere, _ in templates]
    sphere = np.concatenate([sphere for sphere, _ in templates])
    points = _decoded(vector, sphere, np.repeat(patches, sizes), path)
    starts = np.cumsum([0, *sizes])
    triangles = [own + start for (_, own), start in zip(templates, starts, strict=False)]
    return points, np.concatenate([own if signed_volume(points, own) >= 0 else own[:, ::-1] for own in triangles])


def _decoded(
    vector: NDArray[np.floating], sphere: NDArray[np.floating], patch: NDArray[np.integer], path: str | Path | None
) -> NDArray[np.float32]:
    """Where points of the sphere (m, 3), each of a patch (m,), go for a feature (1024,): (m, 3)."""
    feature, points = vector.astype(np.float32)[None], sphere.astype(np.float32)[None]
    return _decoder(path).run(feature=feature, sphere=points, patch=patch.astype(np.int64)[None])[0][0]


def _decoder(path: str | Path | None) -> OnnxModel:
    return load_network(FOLDER / DECODER_FILE if path is None else Path(path))

"""How far poses are off: centimetres, degrees, also up to symmetry; and what a loss in a form's space is worth."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from ..geometry.arrays import Floats
from ..poses import FORMS
from ..scene.mesh import Mesh

Matrices = NDArray[np.floating]

SYMMETRY_TOLERANCE = 0.01
"""A mesh is symmetric where every point has one within this share of the mesh's radius after the turn."""


def translation_errors(found: Matrices, truth: Matrices) -> Floats:
    """Centimetres between the origins of poses (..., 4, 4) in metres: ``100 |t' - t|``."""
    return 100.0 * np.linalg.norm(np.float64(found[..., :3, 3]) - truth[..., :3, 3], axis=-1)


def rotation_errors(found: Matrices, truth: Matrices, folds: NDArray[np.integer] | None = None) -> Floats:
    """Degrees of the turn from one rotation to the other, 0..180: the geodesic distance on SO(3).

    angle(R^T R') (Huynh, "Metrics for 3D rotations", 2009, Phi_6), by the quaternion: exact for small angles too.

    Parameters
    ----------
    found, truth
        (..., 4, 4), rigid.
    folds
        int (...,): symmetry about the object's own z axis: n for n-fold, 0 for any angle, 1 for none. The smallest
        angle over all equivalent poses is told.
    """
    turn = np.swapaxes(np.float64(truth[..., :3, :3]), -1, -2) @ np.float64(found[..., :3, :3])
    x, y, z, w = np.moveaxis(Rotation.from_matrix(turn.reshape(-1, 3, 3)).as_quat(), -1, 0)
    twist = 2 * np.arctan2(z, w)  # about the object's own z: what a symmetric object does not show
    if folds is not None:
        fold = np.broadcast_to(folds, found.shape[:-2]).reshape(-1)
        step = 2 * np.pi / np.maximum(fold, 1)
        rest = np.where(fold == 0, 0.0, twist - step * np.round(twist / step))
    else:
        rest = twist
    swing = np.hypot(w, z)
    degrees = np.degrees(
        2 * np.arctan2(np.sqrt(x**2 + y**2 + (swing * np.sin(rest / 2)) ** 2), np.abs(swing * np.cos(rest / 2)))
    )
    return degrees.reshape(found.shape[:-2])


def folds_of(mesh: Mesh) -> int:
    """Symmetry of a mesh about the vertical axis of its frame: 1, 2, 4, or 0 for every angle.

    Points are compared after turns of 180, 90 and 30 degrees (12-fold and more counts as round).
    """
    points = np.unique(np.float64(mesh.points[np.isfinite(mesh.points).all(axis=1)]), axis=0)
    if len(points) < 3:
        return 1
    from scipy.spatial import cKDTree

    tree, limit = cKDTree(points), SYMMETRY_TOLERANCE * float(np.linalg.norm(points, axis=1).max())

    def same(degrees: float) -> bool:
        """Is the point cloud the same after a turn about z?"""
        turned = points @ Rotation.from_euler("z", degrees, degrees=True).as_matrix().T
        return bool(np.max(tree.query(turned)[0]) <= limit)

    if same(30):
        return 0
    return 4 if same(90) else 2 if same(180) else 1


def summary(values: NDArray[np.floating]) -> dict[str, float]:
    """Median and 95th percentile."""
    return {"median": float(np.median(values)), "p95": float(np.percentile(values, 95))}


def r_squared(found: NDArray[np.floating], truth: NDArray[np.floating], mean: NDArray[np.floating]) -> float:
    """1 - sum (x' - x)^2 / sum (x - mean)^2 over all channels: 0 for predicting ``mean``, 1 for the truth."""
    return float(1 - ((found - truth) ** 2).sum() / ((truth - mean) ** 2).sum())


def invalidity(features: NDArray[np.floating], form: str) -> float:
    """How far raw output is from any pose: median of |x - project(x)| / |project(x)| over rows (K, width).

    Both have their rotation part's sign and size freed first: a motor times a number is the same motor. So x is scaled
    by the number that brings it nearest to its projection. Rows that have no nearest pose count as 1.
    """
    x = np.asarray(features, np.float64)
    y = projected(x, form)
    norm = (y * y).sum(axis=1)
    factor = (
        np.where(norm > 0, (x * y).sum(axis=1) / np.maximum(norm, 1e-12), 1.0) if _is_motor(form) else np.ones(len(x))
    )
    y = y * factor[:, None]
    size = np.linalg.norm(y, axis=1)
    off = np.linalg.norm(x - y, axis=1) / np.maximum(size, 1e-12)
    return float(np.median(np.minimum(off, 1.0)))


def _is_motor(form: str) -> bool:
    return form.startswith(("pga", "cga", "dual"))


def projected(features: NDArray[np.floating], form: str) -> Floats:
    """Nearest valid features of raw output (K, width); rows of zeros, which have none, are nudged first."""
    x = np.asarray(features, np.float64)
    empty = np.abs(x).max(axis=1, keepdims=True) < 1e-9
    return FORMS[form].project(x + np.where(empty, 1e-6, 0.0))


def decoded(features: NDArray[np.floating], form: str) -> Matrices:
    """Rigid poses (K, 4, 4) of raw output: projected, decoded, and of an affine the rotation only."""
    return FORMS["matrix"].encode(FORMS[form].decode(projected(features, form))).reshape(-1, 4, 4)


def pose_report(raw: NDArray[np.floating], truth: Matrices, form: str, folds: Any = None) -> Mapping[str, float]:
    """Errors of raw output (K, width) for rigid poses (K, 4, 4), after decoding: cm, degrees, validity."""
    poses = decoded(raw, form)
    centimetres, degrees = summary(translation_errors(poses, truth)), summary(rotation_errors(poses, truth))
    result = {f"cm_{name}": value for name, value in centimetres.items()}
    result |= {f"degrees_{name}": value for name, value in degrees.items()}
    if folds is not None:
        result |= {f"degrees_symmetric_{name}": v for name, v in summary(rotation_errors(poses, truth, folds)).items()}
    return result | {"invalidity": invalidity(raw, form)}

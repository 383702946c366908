"""Draws held-out meshes beside what comes back from their features."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...meshes import decode_mesh
from ...meshes.shape_feature import default_encoder
from ...meshes.shape_files import ShapeFile
from ...meshes.triangulate import inner_triangles
from ...runtime.matplotlib_figure import new_figure
from ...scene.mesh import Mesh
from ..figures import save_figure

LIGHT = np.array([0.35, -0.6, 0.72])
COLUMNS = 6


def draw_meshes(models: Sequence[ShapeFile], paths: Sequence[Path]) -> None:
    """Two rows of pictures: models (at most six) and their decoded meshes.

    Raises
    ------
    MissingPackageError
        If matplotlib is not installed.
    """
    shown = list(models)[:COLUMNS]
    figure = new_figure(2.2 * COLUMNS, 4.6)
    for place, model in enumerate(shown):
        decoded = decode_mesh(default_encoder().encode([model.mesh])[0], 2000)
        for row, mesh in enumerate((model.mesh, decoded)):
            axes: Any = figure.add_subplot(2, COLUMNS, 1 + place + row * COLUMNS, projection="3d")
            _draw(axes, mesh, model.mesh)
            axes.set_title(f"{model.name}" if row == 0 else "decoded", fontsize=9)
    save_figure(figure, paths)


def _draw(axes: Any, mesh: Mesh, frame: Mesh) -> None:
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]

    corners = mesh.points[inner_triangles(mesh)].astype(np.float64)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    shade = 0.35 + 0.6 * np.abs(normals @ LIGHT)
    axes.add_collection3d(Poly3DCollection(corners, facecolors=np.outer(shade, (0.55, 0.7, 0.95)).clip(0, 1)))
    middle, reach = frame.bounds.mean(axis=0), np.ptp(frame.bounds, axis=0).max() / 2
    for axis, center in zip("xyz", middle, strict=True):
        getattr(axes, f"set_{axis}lim")(center - reach, center + reach)
    axes.set_box_aspect((1, 1, 1))
    axes.set_axis_off()
    axes.view_init(elev=22, azim=-55)

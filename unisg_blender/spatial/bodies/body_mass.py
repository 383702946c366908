"""What things weigh: kilograms in a cubic metre of the hulls of their parts, by category."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from ...scene.graph import SceneGraph
from ...scene.hierarchy import world_matrices
from .hull_pieces import convex_pieces

LEAST = 1e-3
"""Kilograms of a body at least: simulators divide by it."""

USUAL = 250.0
"""Furniture: boards with air between them."""

DENSITIES = {
    "Book": 700.0, "Cushion": 60.0, "Sofa": 80.0, "Armchair": 80.0, "Mattress": 50.0, "Bed": 100.0, "Rug": 300.0,
    "Drape": 300.0, "Swab": 150.0, "Curtain": 200.0, "Patient": 1000.0, "Knee": 1000.0, "Scalpel": 5000.0,
    "Forceps": 5000.0, "Clamp": 5000.0, "Scissors": 5000.0, "Retractor": 5000.0, "Mallet": 3000.0,
    "Implant": 4500.0, "Bone Saw": 3000.0,
    "Tray": 2700.0, "Bowl": 2700.0, "Kidney Dish": 2700.0, "Kick Bucket": 2700.0, "Cup": 2300.0, "Vase": 2300.0,
    "Bottle": 1000.0, "Vial": 2000.0, "IV Bag": 1000.0, "Anaesthesia Machine": 350.0, "Television": 400.0,
}  # fmt: skip


def density_of(graph: SceneGraph, row: int) -> float:
    """kg/m3 of a row's category, of the nearest one above that has one; :data:`USUAL` where nothing is known."""
    while row >= 0 and graph.category[row] < 0:
        row = int(graph.parent[row])
    return DENSITIES.get(graph.category_name(row), USUAL) if row >= 0 else USUAL


def mass_of(graph: SceneGraph, meshes: Iterable[int]) -> float:
    """Kilograms of the meshes at some rows: their densities times the volumes of the hulls of their parts."""
    world, mass = world_matrices(graph), 0.0
    for row in meshes:
        size = abs(float(np.linalg.det(world[row, :3, :3])))
        for points in convex_pieces(graph.meshes[graph.mesh[row]]):
            try:
                mass += density_of(graph, row) * size * float(ConvexHull(points).volume)
            except QhullError:
                continue
    return max(mass, LEAST)

"""The furniture of the worlds in numbers, by material: ``python -m tests.worlds.recorded_furniture`` records them.

A change of a piece moves the published tables of generators: whoever makes one means it, and records anew.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from unisg_blender.worlds.furniture.kit import Furniture
from unisg_blender.worlds.living_room_world import furnish as furnish_home
from unisg_blender.worlds.operating_room_world import furnish as furnish_theatre

FILE = Path(__file__).with_name("recorded_furniture.json")
SEEDS, MOST = range(8), 3
"""Rooms of each kind that are looked at, and different pieces of a category at most."""

Numbers = dict[str, list[float]]


def pieces() -> dict[str, Furniture]:
    """Different pieces of each category in the order in which they come, by "category number"."""
    found: dict[str, dict[str, Furniture]] = {}
    for furnish in (furnish_theatre, furnish_home):
        for seed in SEEDS:
            for obj in furnish(seed).objects:
                known = found.setdefault(obj.asset.category, {})
                if len(known) < MOST:
                    known.setdefault(obj.asset.mesh.checksum, obj.asset)
    return {f"{name} {number}": piece for name, known in found.items() for number, piece in enumerate(known.values())}


def summary(piece: Furniture) -> Numbers:
    """By material: corners, and their coordinates, and the sizes of these, summed with weights: none moves unseen."""
    mesh = piece.mesh
    face = np.repeat(np.arange(len(mesh.offsets) - 1), np.diff(mesh.offsets))
    assert mesh.material_index is not None
    material = mesh.material_index[face]
    points, weight = mesh.points[mesh.corners].astype(np.float64), 1 + np.arange(len(face)) % 7
    found = {}
    for number, name in enumerate(mesh.materials):
        mine = material == number
        both = np.concatenate([points[mine], np.abs(points[mine])], axis=1)
        sums = (both * weight[mine, None]).sum(axis=0)
        found[name] = [int(mine.sum()), *np.round(sums, 4).tolist()]
    return dict(sorted(found.items()))


if __name__ == "__main__":
    found = {name: summary(piece) for name, piece in sorted(pieces().items())}
    FILE.write_text(json.dumps(found, separators=(",", ":")) + "\n", encoding="utf-8")

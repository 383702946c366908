"""The meshes of procedural rooms, as shapes to learn from."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from ...errors import UniSGError, did_you_mean
from ...meshes.shape_files import ShapeFile
from ...worlds import WORLDS

OF_WORLDS = "worlds/"
"""Beginning of the families of shapes that come from procedural worlds."""


def world_models(worlds: Sequence[str], rooms: int, seed: int = 0, per_category: int = 8) -> list[ShapeFile]:
    """The meshes of procedurally made rooms, each once, at most ``per_category`` of a category.

    ``rooms`` rooms are made of each of the named worlds. One in five meshes, by
    its checksum, is in split "test".

    Raises
    ------
    UniSGError
        If there is no world of a name.
    """
    unknown = sorted(set(worlds) - set(WORLDS))
    if unknown:
        hint = did_you_mean(unknown[0], WORLDS)
        raise UniSGError(f"there is no world {unknown[0]!r}{hint}: choose among {', '.join(WORLDS)}")
    found: dict[str, ShapeFile] = {}
    counts: Counter[str] = Counter()
    for name in worlds:
        for number in range(rooms):
            graph = WORLDS[name](seed + number)
            for row in np.flatnonzero(graph.mesh >= 0):
                mesh, category = graph.meshes[graph.mesh[row]], graph.category_name(int(row))
                if category and mesh.checksum not in found and counts[category] < per_category:
                    counts[category] += 1
                    split = "test" if int(mesh.checksum, 16) % 5 == 0 else "train"
                    found[mesh.checksum] = ShapeFile(category, category, split, f"{OF_WORLDS}{category}", mesh)
    return list(found.values())

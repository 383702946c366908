"""Experiment "scale": the shipped topology network on a field of up to a million cubes."""

from __future__ import annotations

import time
import tracemalloc
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.boxes import Boxes
from ...metrics.edge_metrics import f1_score
from ...predict.object_pairs import candidate_pairs
from ...predict.support_prediction import TopologyModel
from ...spatial import find_objects
from ...worlds.cube_world import cube_pairs

PAIRS_MADE = 500
NEAREST = 4


def field(count: int) -> tuple[Boxes, NDArray[np.bool_]]:
    """Boxes of ``count`` cubes in pairs, one on the other, and which are upper ones; the next box is the lower one's.

    A scene of 500 pairs is laid side by side as often as needed.
    """
    graph = cube_pairs(0, PAIRS_MADE)
    objects = find_objects(graph, empty=False)
    rows, boxes = objects.rows, objects.oriented
    cubes = boxes.take(np.flatnonzero([graph.category_name(int(row)) == "Cube" for row in rows]))
    copies = -(-count // len(cubes.center))
    side, width = int(np.ceil(np.sqrt(copies))), float(np.ptp(cubes.center[:, 0])) + 2.0
    place = np.stack([np.arange(copies) % side, np.arange(copies) // side, np.zeros(copies)], axis=1) * width
    center = (cubes.center + place[:, None]).reshape(-1, 3)[:count]
    axes, half = (np.tile(part, (copies, *[1] * (part.ndim - 1)))[:count] for part in (cubes.axes, cubes.half))
    return Boxes(center, axes, half, np.ones(count, bool)), np.arange(count) % 2 == 1


def run(settings: Mapping[str, Any], data: Path) -> dict[str, Any]:
    """Processor seconds and peak memory of arrays; ``settings``: cubes."""
    boxes, upper = field(settings["cubes"])
    model = TopologyModel()
    tracemalloc.start()
    start = time.process_time()
    pairs = candidate_pairs(boxes, NEAREST)
    middle = time.process_time()
    chances = model.chances(boxes, pairs)
    end = time.process_time()
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    truth = upper[pairs[:, 0]] & (pairs[:, 1] == pairs[:, 0] - 1)
    missed = int(upper.sum()) - int(truth.sum())
    return {
        "candidates": len(pairs),
        "seconds_candidates": round(middle - start, 2),
        "seconds_network": round(end - middle, 2),
        "megabytes": round(peak / 1e6),
        "missed": missed,
        "f1": round(f1_score(chances >= model.threshold, truth, missed), 5),
    }

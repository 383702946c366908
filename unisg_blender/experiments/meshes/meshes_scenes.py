"""Measures category proposals in whole rooms, and for objects of no known category."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...meshes.shape_files import ShapeFile
from ...predict.calibration import KNOWN
from ...predict.category_model import LabelModel
from ...predict.category_proposals import propose_categories
from ...scene.builder import SceneBuilder
from ...scene.graph import SceneGraph
from ...worlds import WORLDS

FIRST_SEED = 10_000
ROOMS = 3
KINDS = tuple((*kinds, "structure") for kinds in (("shape",), ("shape", "neighbours"), ("shape", "name", "neighbours")))


def measure_labelled_rooms(worlds: Sequence[str]) -> list[dict[str, Any]]:
    """Top-1 and top-3 accuracy (%) over all objects of new rooms whose names and categories were taken away.

    With "name" the objects keep their names, which say what they are.
    """
    rows = []
    for world in worlds:
        for use in KINDS:
            hits = np.array([_hits(WORLDS[world](FIRST_SEED + room), use) for room in range(ROOMS)]).sum(axis=0)
            rows.append(
                {
                    "world": world, "evidence": " + ".join(use), "objects": int(hits[0]),
                    "top_1": round(100 * hits[1] / hits[0], 1), "top_3": round(100 * hits[2] / hits[0], 1),
                }
            )  # fmt: skip
    return rows


def _hits(graph: SceneGraph, use: Sequence[str]) -> tuple[int, int, int]:
    truth = [graph.category_name(row) for row in range(len(graph))]
    bare = graph.replace(category=np.full(len(graph), -1, np.int32), vocabulary=())
    asked = [row for row in range(len(graph)) if truth[row]]
    found = propose_categories(bare, rows=asked, use=use)
    first = sum(proposal.best == truth[proposal.row] for proposal in found)
    third = sum(truth[proposal.row] in dict(proposal.categories) for proposal in found)
    return len(found), first, third


def measure_unknown(known: Sequence[ShapeFile], unknown: Sequence[ShapeFile]) -> list[dict[str, Any]]:
    """Confidence of the best proposal, without names: right, wrong, and for objects of no category in the model."""
    vocabulary = set(LabelModel.load().vocabulary)
    groups: dict[str, list[float]] = {"right": [], "wrong": [], "thing of an unknown category": []}
    for model in [*known, *unknown]:
        builder = SceneBuilder()
        builder.add(model.name, uid="model", mesh=model.mesh)
        proposal = propose_categories(builder.build(), use=("shape",))[0]
        if model.category not in vocabulary:
            groups["thing of an unknown category"].append(proposal.confidence)
        else:
            groups["right" if proposal.best == model.category else "wrong"].append(proposal.confidence)
    return [
        {
            "best proposal": name, "meshes": len(values),
            "confidence_median": round(float(np.median(values)), 3) if values else None,
            "known": round(100 * float(np.mean(np.array(values) >= KNOWN)), 1) if values else None,
        }
        for name, values in groups.items()
    ]  # fmt: skip

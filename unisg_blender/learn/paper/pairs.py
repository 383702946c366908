"""Experiment "pairs": what stands on what in scenes never seen, among pairs that are near each other; directed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...dataset import open_dataset, to_scenegraph
from ...geometry.boxes import Boxes, world_bounds
from ...geometry.rigid_frames import relative_poses
from ...metrics.edge_metrics import average_precision, best_threshold, f1_score
from ...poses import FORMS
from ...predict.object_pairs import box_poses, candidate_pairs, pair_features
from ...scene.graph import SceneGraph
from ...spatial import find_objects
from ...spatial.relations import find_relations

NEAREST = 8
SHARES = {"train": (0.0, 0.6), "validation": (0.6, 0.75), "test": (0.75, 1.0)}
GAP, OVERLAP = 0.01, 0.02


@dataclass(frozen=True, eq=False)
class Pairs:
    """Candidates of some scenes: ``boxes`` of all objects, ``pairs`` (P, 2), ``truth`` (P,); and edges missed."""

    boxes: Boxes
    pairs: NDArray[np.int64]
    truth: NDArray[np.bool_]
    missed: int
    graphs: list[SceneGraph]
    starts: list[int]


@lru_cache(maxsize=3)
def load_pairs(folder: Path, part: str) -> Pairs:
    """The candidates of a share of the scenes; the floor is left out: what stands on it is told by height alone."""
    dataset = open_dataset(folder)
    low, high = (round(end * len(dataset)) for end in SHARES[part])
    found = [_scene_pairs(to_scenegraph(dataset[number])) for number in range(low, high)]
    counts = [len(boxes.center) for _, boxes, *_ in found]
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(int).tolist()
    boxes = Boxes(
        *(np.concatenate([getattr(part[1], name) for part in found]) for name in ("center", "axes", "half", "solid"))
    )
    return Pairs(
        boxes,
        np.concatenate([pairs + start for (_, _, pairs, _, _), start in zip(found, starts, strict=True)]),
        np.concatenate([truth for *_, truth, _ in found]),
        sum(missed for *_, missed in found),
        [graph for graph, *_ in found],
        starts,
    )


def _scene_pairs(graph: SceneGraph) -> tuple[SceneGraph, Boxes, NDArray[np.int64], NDArray[np.bool_], int]:
    objects = find_objects(graph, empty=False)
    rows, boxes = objects.rows, objects.oriented
    kept = np.array([graph.category_name(int(row)) != "Floor" for row in rows])
    rows, boxes = rows[kept], boxes.take(np.flatnonzero(kept))
    place = {int(row): number for number, row in enumerate(rows)}
    pairs = candidate_pairs(boxes, NEAREST)
    edges = {(place[row], place[target]) for row, target in true_edges(graph) if row in place and target in place}
    truth = np.array([tuple(pair) in edges for pair in pairs.tolist()], bool)
    return graph, boxes, pairs, truth, len(edges) - int(truth.sum())


def true_edges(graph: SceneGraph, kind: str = "on_top_of") -> set[tuple[int, int]]:
    """Rows (subject, target) of the relations that the scene itself tells."""
    table = graph.components["relations"]
    entries = zip(table.rows.tolist(), table.columns["kind"], table.columns["target"], strict=True)
    return {(row, graph.row_of_uid[uid]) for row, name, uid in entries if name == kind and uid in graph.row_of_uid}


def features_of(part: Pairs, form: str, poses: str) -> NDArray[np.float64]:
    """What a network sees of the pairs: both world poses, or the target's in the subject's frame and where up is."""
    if poses == "shipped":
        return pair_features(part.boxes, part.pairs).astype(np.float64)
    world = box_poses(part.boxes)
    half = np.log(part.boxes.half)[part.pairs].reshape(len(part.pairs), 6)
    if poses == "absolute":
        written = FORMS[form].encode(world)[part.pairs].reshape(len(part.pairs), -1)
        return np.concatenate([written, half], axis=1)
    relative = FORMS[form].encode(relative_poses(world, part.pairs))
    return np.concatenate([relative, part.boxes.axes[part.pairs[:, 0], 2], half], axis=1)


def run(settings: Mapping[str, Any], data: Path) -> dict[str, Any]:
    """A network over pairs, all seeds side by side; the learning rate by the validation scenes' average precision.

    ``settings``: form, poses ("absolute", "relative", "shipped"), rotation, seeds, steps, rates.
    """
    import torch
    from torch import Tensor, nn

    from ..ensemble import StackedMlp, train_stacked

    parts = {name: load_pairs(data / f"cubes_{settings['rotation']}", name) for name in SHARES}
    raw = {name: features_of(part, settings["form"], settings["poses"]) for name, part in parts.items()}
    mean, spread = raw["train"].mean(axis=0), raw["train"].std(axis=0)
    kept = np.flatnonzero(spread > 1e-6)
    x = {
        name: torch.from_numpy(((value - mean) / np.maximum(spread, 1e-6))[:, kept]).float()
        for name, value in raw.items()
    }
    seeds = list(range(settings["seeds"]))
    truth = torch.from_numpy(parts["train"].truth).float()[:, None]

    def loss(found: Tensor, wanted: Tensor) -> Tensor:
        """Binary cross entropy (B,) of logits (B, N, N), as the paper has for edges."""
        return nn.functional.binary_cross_entropy_with_logits(found, wanted, reduction="none").mean(dim=(1, 2))

    rates = settings["rates"]
    each = [seed for seed in seeds for _ in rates]
    network = StackedMlp(len(kept), 1, each)
    together = (x["train"].expand(len(seeds), -1, -1), truth.expand(len(seeds), -1, -1))
    train_stacked(network, *together, rates * len(seeds), loss, seeds, settings["steps"], batch=128)
    with torch.no_grad():
        score = {name: network(x[name].expand(len(each), -1, -1))[..., 0].numpy() for name in ("validation", "test")}
    judged = [average_precision(value, parts["validation"].truth) for value in score["validation"]]
    best = int(np.argmax(np.reshape(judged, (len(seeds), len(rates))).mean(axis=0)))
    rows = [judge(score["validation"][k], score["test"][k], parts) for k in range(best, len(each), len(rates))]
    return {"parameters": network.parameters_each, "channels_learned": len(kept), "rate": rates[best], "rows": rows}


def judge(validation: NDArray[np.floating], test: NDArray[np.floating], parts: Mapping[str, Pairs]) -> dict[str, float]:
    """Average precision and F1 in the test scenes, the threshold from the validation scenes."""
    limit = best_threshold(validation, parts["validation"].truth)
    truth, missed = parts["test"].truth, parts["test"].missed
    return {"average_precision": average_precision(test, truth), "f1": f1_score(test >= limit, truth, missed)}


def run_rules(settings: Mapping[str, Any], data: Path) -> dict[str, Any]:
    """What needs no training: nearness of the middles, a rule on boxes, and the geometric rule on surfaces.

    ``settings``: rotation.
    """
    parts = {name: load_pairs(data / f"cubes_{settings['rotation']}", name) for name in ("validation", "test")}
    near = {name: -_distance(part) for name, part in parts.items()}
    test = parts["test"]
    boxed = box_rule(test.boxes, test.pairs)
    exact = _surface_rule(test)
    return {
        "candidates": len(test.pairs),
        "edges": int(test.truth.sum()) + test.missed,
        "missed": test.missed,
        "rules": {
            "distance of the middles": judge(near["validation"], near["test"], parts),
            "rule on boxes": {"f1": f1_score(boxed, test.truth, test.missed)},
            "geometric rule (surfaces)": {"f1": f1_score(exact, test.truth, test.missed)},
        },
    }


def _distance(part: Pairs) -> NDArray[np.float64]:
    center = part.boxes.center[part.pairs]
    return np.linalg.norm(center[:, 0] - center[:, 1], axis=1)


def box_rule(boxes: Boxes, pairs: NDArray[np.int64]) -> NDArray[np.bool_]:
    """The subject's lowest point is within 1 cm above and 2 cm below the target's highest, and they share ground."""
    low, high = world_bounds(boxes)
    one, two = pairs[:, 0], pairs[:, 1]
    rise = low[one, 2] - high[two, 2]
    common = np.minimum(high[one, :2], high[two, :2]) - np.maximum(low[one, :2], low[two, :2])
    return (rise <= GAP) & (rise >= -OVERLAP) & (common > 0).all(axis=1)


def _surface_rule(part: Pairs) -> NDArray[np.bool_]:
    found = set()
    for graph, start in zip(part.graphs, part.starts, strict=True):
        rows = find_objects(graph, empty=False).rows
        kept = [int(row) for row in rows if graph.category_name(int(row)) != "Floor"]
        place = {row: start + number for number, row in enumerate(kept)}
        found |= {
            (place[one], place[two]) for one, kind, two in find_relations(graph)
            if kind == "on_top_of" and one in place and two in place
        }  # fmt: skip
    return np.array([tuple(pair) in found for pair in part.pairs.tolist()], bool)

"""Train the network that tells which object stands on which, on datasets whose scenes tell it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.utils.data import TensorDataset
from tqdm import tqdm

from ...dataset.format.reader import Dataset
from ...dataset.scenes_with_shapes import scenes_with_shapes
from ...errors import UniSGError
from ...metrics.edge_metrics import average_precision, best_threshold, f1_score
from ...predict.object_pairs import PAIR_CHANNELS, candidate_pairs, pair_features
from ...predict.prediction_session import VERSION
from ...predict.support_prediction import KIND
from ...runtime.onnx_session import metadata_text
from ...scene import SceneGraph
from ...spatial import find_objects
from ..hyperparameters import Settings
from ..onnx_export import export_onnx
from ..provenance import several
from ..trainer import loader
from ..training_job import Prepared
from ..training_scenes import split_rows
from .network import PairNetwork

EPOCHS, FORM, BATCH = 20, None, 1024
FEWEST_SCENES = 10


@dataclass(frozen=True, eq=False)
class LabelledPairs:
    """Features (P, C) and truth (P,) of the candidates of some scenes; ``missed`` edges are no candidates."""

    features: NDArray[np.float32]
    truth: NDArray[np.bool_]
    missed: int


def prepare(datasets: Sequence[Dataset], settings: Settings) -> Prepared:
    """The pairs of all scenes; the threshold is chosen by some held-out scenes, and tested on others.

    Raises
    ------
    UniSGError
        Too few scenes, no relations, or ``settings.paper`` or ``settings.form``: this job has one architecture.
    """
    if settings.paper or settings.form:
        raise UniSGError("'train topology' has one architecture; the paper's is in 'unisg benchmark paper'")
    scenes = [pairs_of(graph) for graph in _scenes(datasets, settings.quiet)]
    if len(scenes) < FEWEST_SCENES or not sum(int(scene.truth.sum()) for scene in scenes):
        raise UniSGError(f"{len(scenes)} scenes with relations {KIND!r} are too few: give {FEWEST_SCENES} or more")
    rows = split_rows(len(scenes), settings.seed, parts=2)
    train, val, test = (joined([scenes[row] for row in part]) for part in rows)
    torch.manual_seed(settings.seed)
    spread = train.features.std(axis=0)
    network = PairNetwork(train.features.mean(axis=0), np.where(spread > 1e-6, spread, 1.0))
    loaders = [loader(_items(part), BATCH, settings, shuffle=part is train) for part in (train, val)]
    counts = len(rows[0]), len(rows[1]) + len(rows[2])
    return Prepared(network, loaders, counts, None, (val, test), facts=several(datasets))


def export(prepared: Prepared, source: dict[str, Any], out: Path) -> None:
    """Write the model with its threshold; what it gives in the test scenes goes into ``source``."""
    threshold, source["test"] = _measured(prepared.network, *prepared.beside)
    write_topology(prepared.network, threshold, source, out)


def _scenes(datasets: Sequence[Dataset], quiet: bool) -> list[SceneGraph]:
    total = sum(map(len, datasets))
    bar = tqdm(total=total, desc="reading scenes", disable=quiet, unit="scene")
    found = []
    for dataset in datasets:
        for graph in scenes_with_shapes(dataset):
            bar.update()
            if "relations" in graph.components:
                found.append(graph)
    bar.close()
    return found


def pairs_of(graph: SceneGraph) -> LabelledPairs:
    """The candidates of a scene, and which of them the scene's own relations name."""
    objects = find_objects(graph, empty=False)
    rows, boxes = objects.rows, objects.oriented
    pairs = candidate_pairs(boxes)
    place = {int(row): number for number, row in enumerate(rows)}
    table = graph.components["relations"]
    edges = {
        (place[row], place[target])
        for row, kind, uid in zip(table.rows.tolist(), table.columns["kind"], table.columns["target"], strict=True)
        if kind == KIND and row in place and (target := graph.row_of_uid.get(uid, -1)) in place
    }
    truth = np.array([tuple(pair) in edges for pair in pairs.tolist()], bool)
    return LabelledPairs(pair_features(boxes, pairs), truth, len(edges) - int(truth.sum()))


def joined(scenes: Sequence[LabelledPairs]) -> LabelledPairs:
    """The pairs of all scenes."""
    features = np.concatenate([scene.features for scene in scenes])
    return LabelledPairs(
        features, np.concatenate([scene.truth for scene in scenes]), sum(scene.missed for scene in scenes)
    )


def _items(pairs: LabelledPairs) -> TensorDataset:
    return TensorDataset(torch.from_numpy(pairs.features), torch.from_numpy(pairs.truth).float())


def terms(network: nn.Module, batch: Sequence[Tensor]) -> dict[str, Tensor]:
    features, truth = batch
    return {"loss": nn.functional.binary_cross_entropy_with_logits(network(features), truth)}


def _measured(network: nn.Module, validation: LabelledPairs, test: LabelledPairs) -> tuple[float, dict[str, Any]]:
    """The chance with the best F1 in the validation scenes, and what it gives in the test scenes."""
    with torch.no_grad():
        score = [network(torch.from_numpy(part.features)).sigmoid().numpy() for part in (validation, test)]
    threshold = best_threshold(score[0], validation.truth)
    return threshold, {
        "pairs": len(test.truth),
        "edges": int(test.truth.sum()) + test.missed,
        "missed_by_candidates": test.missed,
        "average_precision": round(average_precision(score[1], test.truth), 5),
        "f1": round(f1_score(score[1] >= threshold, test.truth, test.missed), 5),
    }


def write_topology(network: nn.Module, threshold: float, source: dict[str, Any], out: Path) -> None:
    """Write the network as an ONNX file with its contract."""
    metadata = metadata_text("topology", VERSION, channels=list(PAIR_CHANNELS), threshold=threshold, provenance=source)
    inputs = {"features": torch.zeros(3, len(PAIR_CHANNELS))}
    export_onnx(network, inputs, ["logits"], {"features": {0: "pairs"}}, metadata, out)

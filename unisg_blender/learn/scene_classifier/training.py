"""Train the network that tells what kind of scene it is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.utils.data import Dataset as Items
from torch_geometric.data import Batch, HeteroData
from tqdm import tqdm

from ...dataset.format.gather import gather
from ...dataset.format.reader import Dataset
from ...dataset.graphs.graph_arrays import GraphArrays, graph_arrays
from ...dataset.rebuild import to_scenegraph
from ...errors import UniSGError
from ...poses import FORMS
from ...predict.familiarity import Familiarity, object_categories
from ...predict.prediction_session import VERSION
from ...predict.scene_kind import COMPONENTS, graph_inputs
from ...runtime.onnx_session import metadata_text
from ..hetero_sage import FAMILY, EdgeKind
from ..hyperparameters import Settings
from ..onnx_export import export_onnx
from ..provenance import several
from ..trainer import loader
from ..training_job import Prepared
from .network import SceneClassifier

EPOCHS, FORM, BATCH = 30, "sixd", 16
FEWEST_SCENES, HELD_OUT = 4, 0.2
TURNS = 4
NODES = ("entity", *COMPONENTS)
EDGES = {"parents": FAMILY[0], **{f"has_{kind}": ("entity", "has", kind) for kind in COMPONENTS}}
"""Edges by the names of the network's inputs."""


@dataclass(frozen=True, eq=False)
class Labelled:
    """A scene with its kind as a graph, its whole affines (N, 4, 4), which rows are roots, and its objects' categories.

    The features are made by what prediction uses, which needs no torch; so not by ``to_heterodata``.
    """

    graph: HeteroData
    local: NDArray[np.float64]
    roots: NDArray[np.int64]
    categories: tuple[str, ...]

    @staticmethod
    def of(
        arrays: GraphArrays, local: NDArray[np.float64], kind: int, form: str, mesh: str, categories: Sequence[str]
    ) -> Labelled:
        """From a scene's arrays, with poses in a ``form``."""
        inputs, graph = graph_inputs(arrays, mesh), HeteroData()
        inputs["trs"] = FORMS[form].encode(local, stretch=True).astype(np.float32)
        for node in NODES:
            graph[node].x = torch.from_numpy(inputs[node])
        for name, edge in EDGES.items():
            graph[edge].edge_index = torch.from_numpy(np.ascontiguousarray(inputs[name]))
        graph.y = torch.tensor([kind])
        roots = np.setdiff1d(np.arange(len(local)), inputs["parents"][1])
        return Labelled(graph, local, roots, tuple(categories))


class StandaloneClassifier(nn.Module):
    """The classifier with the standardisation of its inputs inside."""

    def __init__(self, mean: Mapping[str, Tensor], scale: Mapping[str, Tensor], kinds: int, hidden: int = 32) -> None:
        super().__init__()
        for node in NODES:
            self.register_buffer(f"{node}_mean", mean[node])
            self.register_buffer(f"{node}_scale", scale[node])
        self.network = SceneClassifier({node: len(mean[node]) for node in NODES}, kinds, hidden)

    def forward(self, **inputs: Tensor) -> tuple[Tensor, Tensor]:
        """Logits (1, kinds) and embedding (1, hidden) of one scene: features by :data:`NODES`, edges by :data:`EDGES`.

        Edges are int64 (2, E).
        """
        edges = {edge: inputs[name] for name, edge in EDGES.items()}
        scene = torch.zeros_like(inputs["has_info"][0])
        embedding = self._embedding({node: inputs[node] for node in NODES}, edges, scene, 1)
        return self.network.head(embedding), embedding

    def of_batch(self, batch: Batch) -> Tensor:
        """Logits (B, kinds) of scenes side by side."""
        return self.network.head(self.embedding_of(batch))

    def embedding_of(self, batch: Batch) -> Tensor:
        """Embeddings (B, hidden) of scenes side by side."""
        edges = {edge: batch[edge].edge_index for edge in EDGES.values()}
        return self._embedding({node: batch[node].x for node in NODES}, edges, batch["entity"].batch, batch.num_graphs)

    def _embedding(
        self, nodes: Mapping[str, Tensor], edges: Mapping[EdgeKind, Tensor], scene: Tensor, count: int
    ) -> Tensor:
        x = {
            kind: ((value - getattr(self, f"{kind}_mean")) * getattr(self, f"{kind}_scale")).clamp(-10, 10)
            for kind, value in nodes.items()
        }
        back = {(stop, f"rev_{name}", start): pairs.flip(0) for (start, name, stop), pairs in edges.items()}
        return self.network.embedding(x, {**edges, **back}, scene, count)


class LabelledScenes(Items[HeteroData]):
    """Graphs by number, each time turned about the vertical by another angle if ``turned``."""

    def __init__(self, scenes: Sequence[Labelled], form: str, turned: bool, seed: int) -> None:
        self.scenes, self.form, self.turned = scenes, form, turned
        self.rng = np.random.default_rng(seed)

    def __len__(self) -> int:
        return len(self.scenes)

    def __getitem__(self, index: int) -> HeteroData:
        scene = self.scenes[index]
        if not self.turned:
            return scene.graph
        angle, turn = self.rng.uniform(-np.pi, np.pi), np.eye(4)
        turn[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        graph, trs = copy(scene.graph), scene.graph["trs"].x.clone()
        turned = FORMS[self.form].encode(turn @ scene.local[scene.roots], stretch=True)
        trs[scene.roots] = torch.from_numpy(turned).float()
        graph["trs"].x = trs
        return graph


def prepare(datasets: Sequence[Dataset], settings: Settings) -> Prepared:
    """Scenes of all kinds as graphs.

    With ``settings.paper`` mesh nodes have the features of the mesh encoder, which the datasets must hold, else size
    and complexity of the mesh.

    Raises
    ------
    UniSGError
        Too few scenes or kinds, or no mesh features.
    """
    form, mesh = settings.form or FORM, "feature" if settings.paper else "descriptor"
    kinds, scenes = load_labelled(datasets, form, mesh, settings.quiet)
    train, val = ([scenes[row] for row in part] for part in _split(scenes, settings.seed))
    torch.manual_seed(settings.seed)
    network = StandaloneClassifier(*normalisation(train), len(kinds))
    items = [LabelledScenes(part, form, part is train, settings.seed) for part in (train, val)]
    loaders = [loader(part, BATCH, settings, part.turned, Batch.from_data_list) for part in items]
    contract = {"kinds": list(kinds), "form": form, "mesh": mesh}
    return Prepared(network, loaders, (len(train), len(val)), contract, (train, val), facts=several(datasets))


def export(prepared: Prepared, source: dict[str, Any], out: Path) -> None:
    """Write the model, with what is needed to tell that a scene is of no kind that it knows."""
    assert isinstance(prepared.network, StandaloneClassifier)
    kinds, form = prepared.contract["kinds"], prepared.contract["form"]
    seen = familiar_kinds(prepared.network, prepared.beside, kinds, form)
    records = {kind: found.to_record() for kind, found in seen.items()}
    metadata = metadata_text("classifier", VERSION, **prepared.contract, familiar=records, provenance=source)
    write_classifier(prepared.network, metadata, out)


def familiar_kinds(
    network: StandaloneClassifier, scenes: Sequence[Sequence[Labelled]], kinds: Sequence[str], form: str
) -> dict[str, Familiarity]:
    """What scenes of each kind are like: those learned from, and how far from them held-out ones lie.

    ``scenes`` are both, in this order; all are turned about the vertical, the held-out ones several times.
    """
    found = {}
    for number, kind in enumerate(kinds):
        seen, held_out = ([scene for scene in part if int(scene.graph.y) == number] for part in scenes)
        near = _embedded(network, LabelledScenes(seen, form, True, number))
        far = _embedded(network, LabelledScenes(held_out * TURNS, form, True, number))
        shares = [sum(map(bool, scene.categories)) / max(1, len(scene.categories)) for scene in seen]
        categories = {name for scene in seen for name in scene.categories if name}
        found[kind] = Familiarity.learned(near, far, categories, shares)
    return found


def _embedded(network: StandaloneClassifier, scenes: LabelledScenes) -> NDArray[np.float32]:
    with torch.no_grad():
        parts = [network.embedding_of(Batch.from_data_list([scenes[row]])) for row in range(len(scenes))]
    return torch.cat(parts).numpy()


def load_labelled(datasets: Sequence[Dataset], form: str, mesh: str, quiet: bool) -> tuple[list[str], list[Labelled]]:
    """The kinds of scenes, sorted, and the scenes; without a label the folder names the kind."""
    found: list[tuple[str, GraphArrays, NDArray[np.float64], list[str]]] = []
    bar = tqdm(total=sum(map(len, datasets)), desc="reading scenes", disable=quiet, unit="scene")
    for dataset in datasets:
        if mesh == "feature" and not dataset.manifest["mesh_feature_width"]:
            raise UniSGError(
                f"{dataset.path} has no mesh features: export it with --mesh-features, or leave out --paper"
            )
        for number in range(len(dataset)):
            bar.update()
            scene = dataset[number]
            arrays = graph_arrays(gather(dataset, [number]), dataset.vocabulary["relations"])
            categories = object_categories(to_scenegraph(scene))
            found.append((scene.label or dataset.path.name, arrays, scene.local(), categories))
    bar.close()
    kinds = sorted({name for name, *_ in found})
    if len(kinds) < 2 or len(found) < FEWEST_SCENES:
        raise UniSGError(
            f"{len(found)} scenes of the kinds {', '.join(kinds)}: give two kinds or more, one dataset of each, "
            "or a dataset with labels"
        )
    scenes = [Labelled.of(arrays, local, kinds.index(name), form, mesh, told) for name, arrays, local, told in found]
    return kinds, scenes


def _split(scenes: Sequence[Labelled], seed: int) -> list[list[int]]:
    """Of every kind a share to train on and one to watch, at least one each."""
    rng = np.random.default_rng(seed)
    parts: tuple[list[int], list[int]] = ([], [])
    kinds = np.array([int(scene.graph.y) for scene in scenes])
    for kind in np.unique(kinds):
        rows = rng.permutation(np.flatnonzero(kinds == kind)).tolist()
        count = max(1, round(HELD_OUT * len(rows)))
        parts[0].extend(rows[count:] or rows)
        parts[1].extend(rows[:count])
    return list(parts)


def normalisation(scenes: Sequence[Labelled]) -> tuple[dict[str, Tensor], dict[str, Tensor]]:
    """Mean and reciprocal spread of the features by node type; 0 for channels that do not vary."""
    mean, scale = {}, {}
    for node in NODES:
        every = torch.cat([scene.graph[node].x for scene in scenes]).double().numpy()
        width = every.shape[1]
        spread = every.std(axis=0) if len(every) else np.zeros(width)
        mean[node] = torch.tensor(every.mean(axis=0) if len(every) else np.zeros(width), dtype=torch.float32)
        factor = np.divide(1.0, spread, out=np.zeros(width), where=spread > 1e-6)
        scale[node] = torch.tensor(factor, dtype=torch.float32)
    return mean, scale


def terms(network: nn.Module, batch: Batch) -> dict[str, Tensor]:
    """The loss of a batch, and the share of scenes whose kind is right."""
    assert isinstance(network, StandaloneClassifier)
    logits = network.of_batch(batch)
    right = (logits.argmax(1) == batch.y).float().mean()
    return {"loss": nn.functional.cross_entropy(logits, batch.y), "accuracy": right}


def example_inputs(network: nn.Module, entities: int = 5) -> dict[str, Tensor]:
    """Inputs of the right kinds: a chain of entities, each with all components."""
    row = torch.arange(entities)
    inputs = {node: torch.zeros(entities, len(getattr(network, f"{node}_mean"))) for node in NODES}
    return (
        inputs
        | {"parents": torch.stack([row[:-1], row[1:]])}
        | {f"has_{kind}": torch.stack([row, row]) for kind in COMPONENTS}
    )


def write_classifier(network: nn.Module, metadata: str, out: Path) -> None:
    """Write the network as an ONNX file with its contract."""
    inputs = example_inputs(network)
    dynamic = {name: {0 if name in NODES else 1: name} for name in inputs}
    export_onnx(network, inputs, ["logits", "embedding"], dynamic, metadata, out)

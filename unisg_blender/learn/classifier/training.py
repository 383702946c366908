"""Train the network that tells what kind of scene it is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.utils.data import Dataset as Items
from tqdm import tqdm

from ...dataset.format.gather import gather
from ...dataset.format.reader import Dataset
from ...dataset.graphs.graph_arrays import GraphArrays, graph_arrays
from ...errors import UniSGError
from ...poses import FORMS
from ...predict.prediction_session import VERSION
from ...predict.scene_kind import COMPONENTS, graph_inputs
from ...runtime.onnx_session import metadata_text
from ..onnx_export import export_onnx
from ..provenance import provenance
from ..settings import Settings
from ..trainer import Schedule, fit, loader
from .network import SceneClassifier

FORM, EPOCHS, BATCH = "sixd", 30, 16
FEWEST_SCENES, HELD_OUT = 4, 0.2
NODES = ("entity", *COMPONENTS)


@dataclass(frozen=True, eq=False)
class Labelled:
    """A scene: what the network takes, whole affines (N, 4, 4), which rows are roots, and its kind."""

    inputs: dict[str, NDArray[Any]]
    local: NDArray[np.float64]
    roots: NDArray[np.int64]
    kind: int


class StandaloneClassifier(nn.Module):
    """The classifier with the standardisation of its inputs inside."""

    def __init__(self, mean: Mapping[str, Tensor], scale: Mapping[str, Tensor], kinds: int, hidden: int = 32) -> None:
        super().__init__()
        for node in NODES:
            self.register_buffer(f"{node}_mean", mean[node])
            self.register_buffer(f"{node}_scale", scale[node])
        self.network = SceneClassifier({node: len(mean[node]) for node in NODES}, kinds, hidden)

    def forward(
        self, entity: Tensor, info: Tensor, trs: Tensor, mesh: Tensor, action: Tensor, parents: Tensor,
        has_info: Tensor, has_trs: Tensor, has_mesh: Tensor, has_action: Tensor,
    ) -> Tensor:  # fmt: skip
        """Logits (1, kinds) of one scene: features by node type, edges int64 (2, E) by kind."""
        nodes = dict(zip(NODES, (entity, info, trs, mesh, action), strict=True))
        edges = dict(
            zip(
                ("parents", *(f"has_{kind}" for kind in COMPONENTS)),
                (parents, has_info, has_trs, has_mesh, has_action),
                strict=True,
            )
        )
        return self.of_batch(nodes, edges, torch.zeros_like(has_info[0]), 1)

    def of_batch(self, nodes: Mapping[str, Tensor], edges: Mapping[str, Tensor], scene: Tensor, count: int) -> Tensor:
        """Logits (count, kinds) of scenes side by side; ``scene`` int64 (N,) is that of each entity."""
        x = {
            kind: ((value - getattr(self, f"{kind}_mean")) * getattr(self, f"{kind}_scale")).clamp(-10, 10)
            for kind, value in nodes.items()
        }
        both = {
            ("entity", "parent_of", "entity"): edges["parents"],
            ("entity", "rev_parent_of", "entity"): edges["parents"].flip(0),
        }
        for kind in COMPONENTS:
            both["entity", "has", kind], both[kind, "rev_has", "entity"] = (
                edges[f"has_{kind}"],
                edges[f"has_{kind}"].flip(0),
            )
        return self.network(x, both, scene, count)


class _Scenes(Items[Labelled]):
    """Scenes by number, each time turned about the vertical by another angle if ``turned``."""

    def __init__(self, scenes: Sequence[Labelled], form: str, turned: bool, seed: int) -> None:
        self.scenes, self.form, self.turned = scenes, form, turned
        self.rng = np.random.default_rng(seed)

    def __len__(self) -> int:
        return len(self.scenes)

    def __getitem__(self, index: int) -> Labelled:
        scene = self.scenes[index]
        if not self.turned:
            return scene
        angle = self.rng.uniform(-np.pi, np.pi)
        turn = np.eye(4)
        turn[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        trs = scene.inputs["trs"].copy()
        trs[scene.roots] = FORMS[self.form].encode(turn @ scene.local[scene.roots], stretch=True)
        return replace(scene, inputs=scene.inputs | {"trs": trs})


def train(datasets: Sequence[Dataset], out: Path, settings: Settings) -> dict[str, Any]:
    """Train and export; returns the provenance that the model carries.

    With ``settings.paper`` mesh nodes have the features of the mesh encoder, which the datasets must hold, else size
    and complexity of the mesh.

    Raises
    ------
    UniSGError
        Too few scenes or kinds, or no mesh features.
    """
    settings = replace(settings, form=settings.form or FORM, epochs=settings.epochs or EPOCHS)
    mesh = "feature" if settings.paper else "descriptor"
    kinds, scenes = load_labelled(datasets, settings.form or FORM, mesh, settings.quiet)
    rows = _split(scenes, settings.seed)
    train_scenes, val_scenes = ([scenes[row] for row in part] for part in rows)
    torch.manual_seed(settings.seed)
    mean, scale = normalisation(train_scenes)
    network = StandaloneClassifier(mean, scale, len(kinds))
    items = [
        _Scenes(part, settings.form or FORM, part is train_scenes, settings.seed) for part in (train_scenes, val_scenes)
    ]
    loaders = [loader(part, BATCH, settings, part.turned, collate) for part in items]
    schedule = Schedule(settings.epochs or EPOCHS, devices=settings.devices, nodes=settings.nodes)
    losses = fit(network, _terms, loaders[0], loaders[1], schedule, settings)
    source = provenance(datasets[0], settings, len(train_scenes), len(val_scenes), losses, network)
    source["notes"] = []
    source["datasets"] = [{"name": dataset.path.name, "scenes": len(dataset)} for dataset in datasets]
    metadata = metadata_text("classifier", VERSION, kinds=list(kinds), form=settings.form, mesh=mesh, provenance=source)
    write_classifier(network, metadata, out)
    return source


def load_labelled(datasets: Sequence[Dataset], form: str, mesh: str, quiet: bool) -> tuple[list[str], list[Labelled]]:
    """The kinds of scenes, sorted, and the scenes; without a label the folder names the kind."""
    found: list[tuple[str, GraphArrays, NDArray[np.float64]]] = []
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
            found.append((scene.label or dataset.path.name, arrays, scene.local()))
    bar.close()
    kinds = sorted({name for name, *_ in found})
    if len(kinds) < 2 or len(found) < FEWEST_SCENES:
        raise UniSGError(
            f"{len(found)} scenes of the kinds {', '.join(kinds)}: give two kinds or more, one dataset of each, "
            "or a dataset with labels"
        )
    return kinds, [_labelled(arrays, local, kinds.index(name), form, mesh) for name, arrays, local in found]


def _labelled(arrays: GraphArrays, local: NDArray[np.float64], kind: int, form: str, mesh: str) -> Labelled:
    inputs = graph_inputs(arrays, mesh)
    inputs["trs"] = FORMS[form].encode(local, stretch=True).astype(np.float32)
    roots = np.setdiff1d(np.arange(len(local)), inputs["parents"][1])
    return Labelled(inputs, local, roots, kind)


def _split(scenes: Sequence[Labelled], seed: int) -> list[list[int]]:
    """Of every kind a share to train on and one to watch, at least one each."""
    rng = np.random.default_rng(seed)
    parts: tuple[list[int], list[int]] = ([], [])
    for kind in sorted({scene.kind for scene in scenes}):
        rows = rng.permutation([row for row, scene in enumerate(scenes) if scene.kind == kind]).tolist()
        count = max(1, round(HELD_OUT * len(rows)))
        parts[0].extend(rows[count:] or rows)
        parts[1].extend(rows[:count])
    return list(parts)


def normalisation(scenes: Sequence[Labelled]) -> tuple[dict[str, Tensor], dict[str, Tensor]]:
    """Mean and reciprocal spread of the features by node type; 0 for channels that do not vary."""
    mean, scale = {}, {}
    for node in NODES:
        every = np.concatenate([scene.inputs[node] for scene in scenes]).astype(np.float64)
        width = every.shape[1]
        spread = every.std(axis=0) if len(every) else np.zeros(width)
        mean[node] = torch.tensor(every.mean(axis=0) if len(every) else np.zeros(width), dtype=torch.float32)
        factor = np.divide(1.0, spread, out=np.zeros(width), where=spread > 1e-6)
        scale[node] = torch.tensor(factor, dtype=torch.float32)
    return mean, scale


def collate(scenes: Sequence[Labelled]) -> dict[str, Any]:
    """Scenes side by side."""
    nodes = {node: [scene.inputs[node] for scene in scenes] for node in NODES}
    start = {node: np.cumsum([0, *(len(value) for value in values[:-1])]) for node, values in nodes.items()}
    edges = {}
    for name, end in (("parents", "entity"), *((f"has_{kind}", kind) for kind in COMPONENTS)):
        moved = [
            scene.inputs[name] + np.array([[start["entity"][k]], [start[end][k]]]) for k, scene in enumerate(scenes)
        ]
        edges[name] = torch.from_numpy(np.concatenate(moved, axis=1))
    counts = [len(value) for value in nodes["entity"]]
    return {
        "nodes": {node: torch.from_numpy(np.concatenate(values)) for node, values in nodes.items()},
        "edges": edges,
        "scene": torch.from_numpy(np.repeat(np.arange(len(scenes)), counts)),
        "kind": torch.tensor([scene.kind for scene in scenes]),
    }


def _terms(network: nn.Module, batch: Mapping[str, Any]) -> dict[str, Tensor]:
    assert isinstance(network, StandaloneClassifier)
    logits = network.of_batch(batch["nodes"], batch["edges"], batch["scene"], len(batch["kind"]))
    right = (logits.argmax(1) == batch["kind"]).float().mean()
    return {"loss": nn.functional.cross_entropy(logits, batch["kind"]), "accuracy": right}


def example_inputs(network: StandaloneClassifier, entities: int = 5) -> dict[str, Tensor]:
    """Inputs of the right kinds: a chain of entities, each with all components."""
    row = torch.arange(entities)
    inputs = {node: torch.zeros(entities, len(getattr(network, f"{node}_mean"))) for node in NODES}
    return (
        inputs
        | {"parents": torch.stack([row[:-1], row[1:]])}
        | {f"has_{kind}": torch.stack([row, row]) for kind in COMPONENTS}
    )


def write_classifier(network: StandaloneClassifier, metadata: str, out: Path) -> None:
    """Write the network as an ONNX file with its contract."""
    inputs = example_inputs(network)
    dynamic = {name: {0 if name in NODES else 1: name} for name in inputs}
    export_onnx(network, inputs, ["logits"], dynamic, metadata, out)

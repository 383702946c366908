"""What kind of scene it is, by a trained network over the UniSG graph."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import softmax

from ..dataset.format.columns import Vocabulary
from ..dataset.format.encoding import Sample, encode_scenes
from ..dataset.graphs.graph_arrays import GraphArrays, graph_arrays
from ..dataset.told_categories import told_categories
from ..errors import UniSGError
from ..poses import FORMS
from ..runtime.json_records import from_record
from ..runtime.onnx_session import damaged
from ..scene.graph import SceneGraph
from ..words.room_kinds import room_kind
from .familiarity import Familiarity, object_categories
from .prediction_session import load_network

MESHES = ("descriptor", "feature")
COMPONENTS = ("info", "trs", "mesh", "action")


def graph_inputs(arrays: GraphArrays, mesh: str) -> dict[str, NDArray[Any]]:
    """Features by node type and edges by kind, as the network takes them; entities show the box of their mesh.

    Parameters
    ----------
    mesh
        "descriptor" (box and complexity) or "feature" (of a mesh encoder).
    """
    nodes, edges = arrays.nodes, arrays.edges
    found: dict[str, NDArray[Any]] = {name: nodes[name]["x"] for name in ("entity", "info", "trs")}
    found["mesh"] = nodes["mesh"]["x" if mesh == "descriptor" else "feature"]
    found["action"] = np.concatenate([nodes["action"]["x"], nodes["action"]["mask"]], axis=1)
    found = {name: np.ascontiguousarray(value, np.float32) for name, value in found.items()}
    found["parents"] = edges["entity", "parent_of", "entity"]
    return found | {f"has_{kind}": edges["entity", "has", kind] for kind in COMPONENTS}


@dataclass(frozen=True)
class KindOfScene:
    """What a network says of a scene.

    Attributes
    ----------
    chances
        The chance of each kind among those that the network knows, most likely first.
    known, objects
        How many of the scene's objects have a category that scenes of the likeliest kind have, of how many.
    distance
        How many times as far it lies from the nearest scene learned from as held-out ones of that kind at most;
        None where the network does not say.
    foreign
        Whether it is of no kind that the network knows.
    by_things
        The kind of room that its things tell, by their categories and names, "" for none; no network has part in it.
    """

    chances: dict[str, float]
    known: int
    objects: int
    distance: float | None
    foreign: bool
    by_things: str = ""

    @property
    def nearest(self) -> str:
        """The likeliest kind, be it ever so foreign."""
        return next(iter(self.chances))

    @property
    def kind(self) -> str:
        """The kind, "" for none of those that the network knows."""
        return "" if self.foreign else self.nearest

    @property
    def lines(self) -> list[str]:
        """The kind, or "none of these", with how much of the scene is known; then how foreign it is, if it is."""
        likeliest = f"{self.nearest} {self.chances[self.nearest]:.1%}"
        if self.distance is None:
            return [likeliest]
        known = f"({self.known} of {self.objects} objects known)"
        if not self.foreign:
            return [f"{likeliest} {known}"]
        looks = f"; by its things it looks like: {self.by_things}" if self.by_things else ""
        return [
            f"none of these {known}{looks}",
            f"{self.distance:.1f} times as far from any {self.nearest} as unseen ones are",
        ]


@dataclass(frozen=True)
class ClassifierRecord:
    """What is read of the model's metadata; models of the first days know no familiar scenes."""

    kinds: tuple[str, ...]
    form: str
    mesh: str
    familiar: Mapping[str, Any] = field(default_factory=dict)
    extra: dict[str, Any] = field(default_factory=dict)


class SceneModel:
    """The classifier, from an ONNX file; the shipped one when ``path`` is omitted."""

    def __init__(self, path: str | os.PathLike[str] | None = None) -> None:
        self.network = load_network("classifier", path)
        self.record = from_record(ClassifierRecord, self.network.metadata, f"{self.network.path}: its metadata")
        self.familiar = {kind: Familiarity.from_record(one) for kind, one in self.record.familiar.items()}
        widths = {known.embeddings.shape[-1] for known in self.familiar.values()}
        if self.record.form not in FORMS or self.record.mesh not in MESHES or len(widths) > 1:
            raise damaged(self.network.path)
        self.network.expect("logits", len(self.kinds))
        if widths:
            self.network.expect("embedding", *widths)

    @property
    def kinds(self) -> tuple[str, ...]:
        """The kinds of scenes that it knows."""
        return self.record.kinds

    def classify(self, graph: SceneGraph, words: Mapping[str, str] | None = None) -> KindOfScene:
        """The chance of each kind, and whether the scene is of any of them; ``words`` is what the user says of words.

        Raises
        ------
        UniSGError
            If the scene has no objects.
        """
        if not len(graph):
            raise UniSGError("the scene has no objects: there is nothing to classify")
        inputs = graph_inputs(self._arrays(graph), self.record.mesh)
        logits, *embedding = self.network.run(**inputs)
        found = zip(self.kinds, softmax(logits[0].astype(np.float64)).tolist(), strict=True)
        chances = dict(sorted(found, key=lambda entry: -entry[1]))
        like = self.familiar.get(next(iter(chances)))
        told = told_categories(graph, sorted(like.categories) if like else (), words)
        categories, things = object_categories(told), room_kind(told_categories(graph, (), words).vocabulary)
        if like is None:
            return KindOfScene(chances, 0, len(categories), None, False, things)
        known, categorised = sum(name in like.categories for name in categories), sum(map(bool, categories))
        distance = like.distance(embedding[0][0])
        foreign = like.is_foreign(distance, known, categorised, len(categories))
        return KindOfScene(chances, known, len(categories), distance, foreign, things)

    def _arrays(self, graph: SceneGraph) -> GraphArrays:
        encoder = None
        if self.record.mesh == "feature":
            from ..meshes.shape_feature import AtlasNetEncoder

            encoder = AtlasNetEncoder()
        names = Vocabulary({"categories": graph.vocabulary})
        return graph_arrays(encode_scenes([Sample(graph)], self.record.form, names, encoder), names.names["relations"])

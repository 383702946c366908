"""What kind of scene it is, by a trained network over the UniSG graph."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import softmax

from ..dataset.format.columns import Vocabulary
from ..dataset.format.encoding import Sample, encode_scenes
from ..dataset.graphs.graph_arrays import GraphArrays, graph_arrays
from ..errors import UniSGError
from ..scene.graph import SceneGraph
from .prediction_session import load_network

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


class SceneModel:
    """The classifier, from an ONNX file; the shipped one when ``path`` is omitted."""

    def __init__(self, path: str | os.PathLike[str] | None = None) -> None:
        self.network = load_network("classifier", path)

    @property
    def kinds(self) -> tuple[str, ...]:
        """The kinds of scenes that it knows."""
        return tuple(self.network.metadata["kinds"])

    def classify(self, graph: SceneGraph) -> dict[str, float]:
        """The chance of each kind, most likely first.

        Raises
        ------
        UniSGError
            If the scene has no objects.
        """
        if not len(graph):
            raise UniSGError("the scene has no objects: there is nothing to classify")
        inputs = graph_inputs(self._arrays(graph), self.network.metadata["mesh"])
        chances = softmax(self.network.run(**inputs)[0][0].astype(np.float64))
        found = zip(self.kinds, chances.tolist(), strict=True)
        return dict(sorted(found, key=lambda entry: -entry[1]))

    def _arrays(self, graph: SceneGraph) -> GraphArrays:
        metadata, encoder = self.network.metadata, None
        if metadata["mesh"] == "feature":
            from ..meshes.shape_feature import AtlasNetEncoder

            encoder = AtlasNetEncoder()
        names = Vocabulary({"categories": graph.vocabulary})
        return graph_arrays(encode_scenes([Sample(graph)], metadata["form"], names, encoder), names.names["relations"])

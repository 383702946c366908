"""Random trees fitted by scikit-learn, and written as an ONNX file that runs without it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import onnx
from numpy.typing import NDArray
from onnx import TensorProto, helper
from sklearn.ensemble import ExtraTreesClassifier

from ... import __version__
from ...runtime.atomic_files import write_file
from ...runtime.onnx_session import KEY

TREES, FEWEST, SEEN = 100, 10, 0.3
"""Trees, examples in a leaf at least, and the share of the features that a split looks at. The mean of many trees that
are split at random knows less of the training rooms by heart than trees that correct each other (boosted ones)."""

NEVER = 1e-4
"""Share of true places, as the trees expect it, that stands for none."""

OPSET, TREES_OPSET, IR_VERSION = 20, 3, 10


def fit_trees(features: NDArray[np.float32], true: NDArray[np.float32], seed: int) -> ExtraTreesClassifier:
    """A classifier of places (N, F) by whether they are true (N,); extremely randomized trees (Geurts et al. 2006)."""
    trees = ExtraTreesClassifier(TREES, min_samples_leaf=FEWEST, max_features=SEEN, random_state=seed)
    return trees.fit(features, true)


def write_trees(trees: ExtraTreesClassifier, metadata: str, path: Path) -> None:
    """Write a classifier of :func:`fit_trees` as an ONNX file.

    It gives the log odds of the share of true places that the trees expect, as "score" (N, 1), and none beyond those of
    :data:`NEVER`.
    """
    ensemble = helper.make_node(
        "TreeEnsembleRegressor", ["features"], ["share"], domain="ai.onnx.ml", n_targets=1, post_transform="NONE",
        aggregate_function="AVERAGE", **_attributes(trees),
    )  # fmt: skip
    nodes = [
        ensemble,
        helper.make_node("Clip", ["share", "least", "most"], ["true"]),
        helper.make_node("Sub", ["one", "true"], ["false"]),
        helper.make_node("Div", ["true", "false"], ["odds"]),
        helper.make_node("Log", ["odds"], ["score"]),
    ]
    constants = {"least": NEVER, "most": 1 - NEVER, "one": 1.0}
    graph = helper.make_graph(
        nodes, "trees",
        [helper.make_tensor_value_info("features", TensorProto.FLOAT, ["places", trees.n_features_in_])],
        [helper.make_tensor_value_info("score", TensorProto.FLOAT, ["places", 1])],
        [helper.make_tensor(name, TensorProto.FLOAT, [], [value]) for name, value in constants.items()],
    )  # fmt: skip
    opsets = [helper.make_opsetid("", OPSET), helper.make_opsetid("ai.onnx.ml", TREES_OPSET)]
    model = helper.make_model(
        graph, opset_imports=opsets, ir_version=IR_VERSION, producer_name="unisg_blender", producer_version=__version__
    )
    helper.set_model_props(model, {KEY: metadata})
    onnx.checker.check_model(model)
    write_file(path, model.SerializeToString())


def _attributes(trees: ExtraTreesClassifier) -> dict[str, Any]:
    """The nodes of all trees, one after another, as the ONNX operator wants them."""
    found: dict[str, list[Any]] = {}

    def add(**columns: Any) -> None:
        for name, values in columns.items():
            found.setdefault(name, []).extend(np.asarray(values).tolist())

    for number, estimator in enumerate(trees.estimators_):
        tree, rows = estimator.tree_, np.arange(estimator.tree_.node_count)
        leaf = tree.children_left < 0
        ends = np.flatnonzero(leaf)
        add(
            nodes_treeids=np.full(len(rows), number), nodes_nodeids=rows,
            nodes_modes=np.where(leaf, "LEAF", "BRANCH_LEQ"),
            nodes_featureids=np.where(leaf, 0, tree.feature), nodes_values=np.where(leaf, 0, _below(tree.threshold)),
            nodes_truenodeids=np.where(leaf, 0, tree.children_left),
            nodes_falsenodeids=np.where(leaf, 0, tree.children_right),
            nodes_missing_value_tracks_true=np.zeros_like(rows), target_treeids=np.full(len(ends), number),
            target_nodeids=ends, target_ids=np.zeros_like(ends), target_weights=tree.value[ends, 0, 1],
        )  # fmt: skip
    return found


def _below(thresholds: NDArray[np.float64]) -> NDArray[np.float32]:
    """The greatest float32 that are no greater: features are float32, so that they fall to the same sides."""
    near = thresholds.astype(np.float32)
    return np.where(near > thresholds, np.nextafter(near, np.float32(-np.inf)), near)

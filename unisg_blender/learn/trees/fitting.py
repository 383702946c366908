"""Boosted trees fitted by scikit-learn, and written as one ONNX node that runs without it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import onnx
from numpy.typing import NDArray
from onnx import TensorProto, helper
from sklearn.ensemble import HistGradientBoostingClassifier

from ... import __version__
from ...runtime.atomic_files import write_file
from ...runtime.onnx_session import KEY

ROUNDS, LEAVES, RATE, SHRINKAGE, FEWEST, SEEN = 200, 4, 0.1, 10.0, 60, 0.3
"""Trees, leaves of each, how much each corrects, how much its leaves are drawn to 0, examples in a leaf, and the share
of the features that a split looks at. Larger ones know the training rooms by heart."""

OPSET, TREES_OPSET, IR_VERSION = 20, 3, 10
NODES = (("featureids", "feature_idx"), ("values", "num_threshold"), ("truenodeids", "left"), ("falsenodeids", "right"))


def fit_trees(features: NDArray[np.float32], true: NDArray[np.float32], seed: int) -> Any:
    """A classifier of places (N, F) by whether they are true (N,)."""
    trees = HistGradientBoostingClassifier(
        max_iter=ROUNDS, max_leaf_nodes=LEAVES, learning_rate=RATE, l2_regularization=SHRINKAGE, early_stopping=False,
        min_samples_leaf=FEWEST, max_features=SEEN, random_state=seed,
    )  # fmt: skip
    return trees.fit(features, true)


def write_trees(trees: Any, width: int, metadata: str, path: Path) -> None:
    """Write a classifier of :func:`fit_trees` of ``width`` features as an ONNX file that gives log odds, "score"."""
    node = helper.make_node(
        "TreeEnsembleRegressor", ["features"], ["score"], domain="ai.onnx.ml", n_targets=1,
        base_values=[float(trees._baseline_prediction.item())], post_transform="NONE", **_attributes(trees),
    )  # fmt: skip
    graph = helper.make_graph(
        [node], "trees",
        [helper.make_tensor_value_info("features", TensorProto.FLOAT, ["places", width])],
        [helper.make_tensor_value_info("score", TensorProto.FLOAT, ["places", 1])],
    )  # fmt: skip
    opsets = [helper.make_opsetid("", OPSET), helper.make_opsetid("ai.onnx.ml", TREES_OPSET)]
    model = helper.make_model(
        graph, opset_imports=opsets, ir_version=IR_VERSION, producer_name="unisg_blender", producer_version=__version__
    )
    helper.set_model_props(model, {KEY: metadata})
    onnx.checker.check_model(model)
    write_file(path, model.SerializeToString())


def _attributes(trees: Any) -> dict[str, Any]:
    """The nodes of all trees, one after another, as the ONNX operator wants them."""
    found: dict[str, list[Any]] = {f"nodes_{name}": [] for name, _ in NODES}
    found |= {f"nodes_{name}": [] for name in ("treeids", "nodeids", "modes", "missing_value_tracks_true")}
    found |= {f"target_{name}": [] for name in ("treeids", "nodeids", "ids", "weights")}
    for number, (tree,) in enumerate(trees._predictors):
        nodes, leaf = tree.nodes, tree.nodes["is_leaf"].astype(bool)
        for name, column in NODES:
            values = np.where(leaf, 0, nodes[column])
            found[f"nodes_{name}"] += [float(v) for v in values] if name == "values" else [int(v) for v in values]
        found["nodes_treeids"] += [number] * len(nodes)
        found["nodes_nodeids"] += list(range(len(nodes)))
        found["nodes_modes"] += ["LEAF" if last else "BRANCH_LEQ" for last in leaf]
        found["nodes_missing_value_tracks_true"] += [0] * len(nodes)
        ends = np.flatnonzero(leaf)
        found["target_treeids"] += [number] * len(ends)
        found["target_nodeids"] += ends.tolist()
        found["target_ids"] += [0] * len(ends)
        found["target_weights"] += [float(value) for value in nodes["value"][ends]]
    return found

"""Outputs that are often asked for are run by a part of the network, which gives the same."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from unisg_blender.runtime.onnx_graph import part_for
from unisg_blender.runtime.onnx_session import KEY, OFTEN, OnnxModel, metadata_text, open_model

pytest.importorskip("onnx")
from onnx import ModelProto, TensorProto, checker, helper


def two_branches() -> bytes:
    """``sum`` is a + weight, ``both`` is a * b + weight; "extra" is an output that nobody names."""
    value = helper.make_tensor_value_info
    nodes = [
        helper.make_node("Add", ["a", "weight"], ["sum"]),
        helper.make_node("Mul", ["a", "b"], ["product"]),
        helper.make_node("Add", ["product", "weight"], ["both"]),
        helper.make_node("Clip", ["sum", "", "most"], ["clipped"]),
    ]
    weights = [helper.make_tensor(name, TensorProto.FLOAT, [], [at]) for name, at in (("weight", 3), ("most", 4))]
    inputs = [value(name, TensorProto.FLOAT, [2]) for name in "ab"]
    outputs = [value(name, TensorProto.FLOAT, [2]) for name in ("sum", "both", "clipped")]
    made = helper.make_model(
        helper.make_graph(nodes, "g", inputs, outputs, weights),
        opset_imports=[helper.make_opsetid("", 17)], ir_version=8,
    )  # fmt: skip
    helper.set_model_props(made, {KEY: metadata_text("test", 1)})
    return made.SerializeToString()


def opened(folder: Path) -> OnnxModel:
    path = folder / "m.onnx"
    path.write_bytes(two_branches())
    return open_model(path, "test", (1,), "cgvae")


@pytest.mark.parametrize(
    ("outputs", "nodes", "inputs", "weights"),
    [
        (["sum"], ["sum"], ["a"], ["weight"]),
        (["both"], ["product", "both"], ["a", "b"], ["weight"]),
        (["clipped"], ["sum", "clipped"], ["a"], ["weight", "most"]),
        (["clipped", "both"], ["sum", "product", "both", "clipped"], ["a", "b"], ["weight", "most"]),
    ],
)
def test_a_part_has_what_its_outputs_need(outputs, nodes, inputs, weights):
    graph = ModelProto.FromString(part_for(two_branches(), outputs)).graph
    checker.check_graph(graph)
    assert [name for node in graph.node for name in node.output] == nodes
    assert [each.name for each in graph.input] == inputs
    assert [each.name for each in graph.initializer] == weights
    assert sorted(each.name for each in graph.output) == sorted(outputs)


def test_metadata_stay_with_a_part():
    parts = ModelProto.FromString(part_for(two_branches(), ["sum"]))
    assert [each.key for each in parts.metadata_props] == [KEY]
    assert parts.opset_import[0].version == 17


def test_what_is_asked_often_gives_the_same_and_inputs_that_are_not_needed_may_be_missing(tmp_path):
    network = opened(tmp_path)
    rng = np.random.default_rng(0)
    for number in range(OFTEN + 4):
        a, b = rng.normal(size=(2, 2)).astype(np.float32)
        found, together = network.run(["sum"], a=a)[0], network.run(["both", "sum"], a=a, b=b, c=b)
        np.testing.assert_array_equal(found, a + np.float32(3))
        np.testing.assert_array_equal(together, [a * b + np.float32(3), a + np.float32(3)])
        assert len(network.run(a=a, b=b)) == 3
        assert set(network._parts) == ({("sum",), ("both", "sum")} if number >= OFTEN else set())

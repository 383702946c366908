"""What a model's file may not make this software do: run for ever, fill the memory, open other files."""

from __future__ import annotations

import time
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from unisg_blender.errors import UniSGError
from unisg_blender.pretrained import FOLDER
from unisg_blender.runtime import onnx_session
from unisg_blender.runtime.onnx_graph import unsafe_part
from unisg_blender.runtime.onnx_session import KEY, OnnxModel, metadata_text, open_model

pytest.importorskip("onnx")
from onnx import AttributeProto, ModelProto, TensorProto, helper

FLOAT, INT, BOOL = TensorProto.FLOAT, TensorProto.INT64, TensorProto.BOOL


def value(name: str, kind: int = FLOAT, shape: list[int] | None = None):
    return helper.make_tensor_value_info(name, kind, shape)


def model(nodes: list, initializers: tuple = (), inputs: tuple = (("x", [1]),)) -> ModelProto:
    graph = helper.make_graph(
        nodes, "g", [value(name, shape=shape) for name, shape in inputs], [value("y")], list(initializers)
    )
    made = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    helper.set_model_props(made, {KEY: metadata_text("test", 1)})
    return made


def opened(made: ModelProto, folder: Path) -> OnnxModel:
    path = folder / "m.onnx"
    path.write_bytes(made.SerializeToString())
    return open_model(path, "test", (1,), "cgvae")


def endless() -> ModelProto:
    body = helper.make_graph(
        [helper.make_node("Identity", ["go"], ["on"]), helper.make_node("Identity", ["a"], ["b"])],
        "body", [value("i", INT, []), value("go", BOOL, []), value("a", shape=[1])],
        [value("on", BOOL, []), value("b", shape=[1])],
    )  # fmt: skip
    return model(
        [helper.make_node("Loop", ["", "t", "x"], ["y"], body=body)], (helper.make_tensor("t", BOOL, [], [True]),)
    )


def branching() -> ModelProto:
    parts = {
        name: helper.make_graph([helper.make_node("Identity", ["x"], [name])], name, [], [value(name)])
        for name in ("then_branch", "else_branch")
    }
    return model([helper.make_node("If", ["t"], ["y"], **parts)], (helper.make_tensor("t", BOOL, [], [True]),))


def with_functions() -> ModelProto:
    made = model([helper.make_node("Neg", ["x"], ["y"])])
    made.functions.append(
        helper.make_function("own", "f", ["a"], ["b"], [helper.make_node("Neg", ["a"], ["b"])],
                             [helper.make_opsetid("", 17)])
    )  # fmt: skip
    return made


def outside() -> ModelProto:
    """Weights of an attribute in another file."""
    made = model([helper.make_node("Constant", [], ["y"], value=helper.make_tensor("w", FLOAT, [1], [1.0]))])
    tensor = made.graph.node[0].attribute[0].t
    tensor.ClearField("float_data")
    tensor.data_location = TensorProto.EXTERNAL
    tensor.external_data.add(key="location", value="/etc/hostname")
    return made


def sparse() -> ModelProto:
    made = model([helper.make_node("Add", ["x", "w"], ["y"])])
    made.graph.sparse_initializer.add(
        values=helper.make_tensor("w", FLOAT, [1], [1.0]), indices=helper.make_tensor("", INT, [1], [0]), dims=[10**12]
    )
    return made


@pytest.mark.parametrize(
    ("make", "text"),
    [
        (endless, "loops or branches"),
        (branching, "loops or branches"),
        (with_functions, "functions of its own"),
        (outside, "weights in other files"),
        (sparse, "sparse weights"),
    ],
)
def test_what_is_not_run_is_refused_before_it_is_loaded(make, text: str, tmp_path: Path) -> None:
    with pytest.raises(UniSGError, match=f"has {text}, which are not run"):
        opened(make(), tmp_path)


def test_a_second_graph_is_looked_at_too(tmp_path: Path) -> None:
    """Who reads a file joins what stands there twice."""
    (tmp_path / "m.onnx").write_bytes(
        endless().SerializeToString() + model([helper.make_node("Neg", ["x"], ["y"])]).SerializeToString()
    )
    with pytest.raises(UniSGError, match="loops or branches"):
        open_model(tmp_path / "m.onnx", "test", (1,), "cgvae")


def test_attributes_of_graphs_are_known_by_their_numbers() -> None:
    fields = AttributeProto.DESCRIPTOR.fields_by_name
    assert [fields[name].number for name in ("t", "g", "tensors", "graphs", "sparse_tensor", "sparse_tensors")] == [
        5, 6, 10, 11, 22, 23,
    ]  # fmt: skip


def test_shipped_models_have_nothing_that_is_refused() -> None:
    assert {path.name: unsafe_part(path.read_bytes()) for path in FOLDER.glob("*.onnx")} == {
        path.name: "" for path in FOLDER.glob("*.onnx")
    }


@pytest.mark.parametrize("kind", ["Expand", "Tile"])
def test_memory_has_a_limit(kind: str, tmp_path: Path) -> None:
    """Neither loading it nor running it takes 640 GB."""
    shape = helper.make_tensor("s", INT, [1], [160 * 10**9])
    one = helper.make_tensor("one", FLOAT, [1], [1.0])
    nodes = [helper.make_node(kind, ["one", "s"], ["c"]), helper.make_node("Add", ["c", "x"], ["y"])]
    huge = opened(model(nodes, (shape, one)), tmp_path)
    with pytest.raises(UniSGError, match="cannot be run"):
        huge.run(x=np.zeros(1, np.float32))


def test_an_input_of_absurd_size_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UniSGError, match="inputs that nothing here has"):
        opened(model([helper.make_node("Neg", ["x"], ["y"])], inputs=(("x", [10**6, 10**6]),)), tmp_path)


def test_time_has_a_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(onnx_session, "MOST_SECONDS", 0.1)
    names = ["x", *(f"m{number}" for number in range(2000)), "y"]
    nodes = [helper.make_node("MatMul", [before, "x"], [after]) for before, after in pairwise(names)]
    slow = opened(model(nodes, inputs=(("x", [600, 600]),)), tmp_path)
    begin = time.monotonic()
    with pytest.raises(UniSGError, match=r"not done after 0.1 s"):
        slow.run(x=np.zeros((600, 600), np.float32))
    assert time.monotonic() - begin < 30


def test_an_output_that_is_not_there_and_an_input_of_another_shape(tmp_path: Path) -> None:
    plain = opened(model([helper.make_node("Neg", ["x"], ["y"])]), tmp_path)
    with pytest.raises(UniSGError, match="has no output 'z'"):
        plain.run(["z"], x=np.zeros(1, np.float32))
    with pytest.raises(UniSGError, match="cannot be run"):
        plain.run(["y"], x=np.zeros((2, 2), np.float32))

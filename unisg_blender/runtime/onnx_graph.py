"""What an ONNX file is made of, looked at before anything of it is run."""

from __future__ import annotations

from collections.abc import Collection
from functools import cache
from typing import Any

FIELDS: dict[str, dict[str, tuple[int, str | None]]] = {
    "Model": {"graph": (7, "Graph"), "functions": (25, "Function")},
    "Function": {"name": (1, None)},
    "Graph": {
        "node": (1, "Node"), "initializer": (5, "Tensor"), "input": (11, "Value"), "output": (12, "Value"),
        "sparse_initializer": (15, "Sparse"),
    },
    "Value": {"name": (1, None)},
    "Node": {"input": (1, None), "output": (2, None), "attribute": (5, "Attribute")},
    "Attribute": {
        "t": (5, "Tensor"), "g": (6, "Graph"), "tensors": (10, "Tensor"), "graphs": (11, "Graph"),
        "sparse": (22, "Sparse"), "sparses": (23, "Sparse"),
    },
    "Tensor": {"name": (8, None), "external_data": (13, "Entry")},
    "Entry": {"key": (1, None)},
    "Sparse": {"values": (1, "Tensor")},
}  # fmt: skip
"""By message of the ONNX format: the fields that are looked at, with number and message (None for text)."""


def unsafe_part(data: bytes) -> str:
    """What a model has that is not run, because it has no end or names other files; "" if nothing.

    Fields that may stand once are looked at as often as they stand: who reads the file joins them.

    Raises
    ------
    ValueError
        If the bytes are no ONNX model.
    """
    from google.protobuf.message import DecodeError

    try:
        model = _message_class()().FromString(data)
    except DecodeError as error:
        raise ValueError(str(error)) from None
    attributes = [item for graph in model.graph for node in graph.node for item in node.attribute]
    tensors = [tensor for graph in model.graph for tensor in graph.initializer]
    tensors += [tensor for item in attributes for tensor in (*item.t, *item.tensors)]
    found = {
        "functions of its own": model.functions,
        "loops or branches": any(item.g or item.graphs for item in attributes),
        "weights in other files": any(tensor.external_data for tensor in tensors),
        "sparse weights": any(graph.sparse_initializer for graph in model.graph)
        or any(item.sparse or item.sparses for item in attributes),
    }
    return next((name for name, there in found.items() if there), "")


def part_for(data: bytes, outputs: Collection[str]) -> bytes:
    """The part of a model that some of its outputs need: to find it anew takes longer than many a run.

    The model has none of what :func:`unsafe_part` finds. One that stands in several pieces is given back whole.
    """
    model = _message_class()().FromString(data)
    if len(model.graph) != 1:
        return data
    (graph,) = model.graph
    needed, nodes = {name.encode() for name in outputs}, []
    for node in reversed(graph.node):  # each stands behind those that it needs
        if needed.intersection(node.output):
            needed.update(filter(None, node.input))
            nodes.append(node)
    _keep(graph.node, nodes[::-1])
    _keep(graph.output, [each for each in graph.output if _name(each) in {name.encode() for name in outputs}])
    for names in (graph.input, graph.initializer):
        _keep(names, [each for each in names if _name(each) in needed])
    return bytes(model.SerializeToString())


def _name(message: Any) -> bytes:
    """The name of a message; the last one counts."""
    return bytes(message.name[-1]) if message.name else b""


def _keep(messages: Any, kept: list[Any]) -> None:
    """Leave only some of the messages of a field."""
    copies = [type(each).FromString(each.SerializeToString()) for each in kept]
    del messages[:]
    messages.extend(copies)


@cache
def _message_class() -> Any:
    """The message "Model" with :data:`FIELDS`; all else in a file is passed over."""
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory

    field = descriptor_pb2.FieldDescriptorProto
    file = descriptor_pb2.FileDescriptorProto(name="unisg_onnx.proto", package="unisg_onnx")
    for name, fields in FIELDS.items():
        message = file.message_type.add(name=name)
        for label, (number, kind) in fields.items():
            described = message.field.add(name=label, number=number, label=field.LABEL_REPEATED)
            described.type = field.TYPE_MESSAGE if kind else field.TYPE_BYTES
            if kind:
                described.type_name = f".unisg_onnx.{kind}"
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName("unisg_onnx.Model"))

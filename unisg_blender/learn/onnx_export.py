"""Trained networks as ONNX files that carry their contract."""

from __future__ import annotations

import contextlib
import inspect
import io
import logging
import warnings
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import onnx
import torch
from torch import Tensor, nn

from ..runtime.atomic_files import write_file
from ..runtime.onnx_session import KEY

OPSET = 20
IR_VERSION = 10
_RANDOM = {
    "RandomNormal",
    "RandomUniform",
    "RandomNormalLike",
    "RandomUniformLike",
    "Multinomial",
    "Bernoulli",
    "Dropout",
}


def export_onnx(
    network: nn.Module,
    inputs: Mapping[str, Tensor],
    outputs: Sequence[str],
    dynamic: Mapping[str, Mapping[int, Any]],
    metadata: str,
    path: Path,
) -> None:
    """Write a network as an ONNX file: opset and IR that Blender's onnxruntime loads, no random operators.

    Parameters
    ----------
    inputs
        Example tensors by name, in the order of the network's ``forward``, which takes them by name.
    outputs
        Names of what it returns.
    dynamic
        Names of the sizes that may vary, by input and dimension.
    metadata
        The contract as JSON.
    path
        Where the file goes, whole or not at all.
    """
    network.eval()
    shapes = [dict.fromkeys(dynamic.get(name, ()), torch.export.Dim.DYNAMIC) or None for name in inputs]
    with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()), _positional(network, list(inputs)):
        warnings.simplefilter("ignore")
        logging.getLogger("torch.onnx").setLevel(logging.ERROR)
        program = torch.onnx.export(
            network, tuple(inputs.values()), dynamo=True, opset_version=OPSET, input_names=list(inputs),
            output_names=list(outputs), dynamic_shapes=tuple(shapes), verbose=False,
        )  # fmt: skip
    assert program is not None
    model = program.model_proto
    model.ir_version = min(model.ir_version, IR_VERSION)
    for node in model.graph.node:
        node.doc_string = ""
        del node.metadata_props[:]
    del model.metadata_props[:]
    entry = model.metadata_props.add()
    entry.key, entry.value = KEY, metadata
    _check(model)
    write_file(path, model.SerializeToString())


@contextlib.contextmanager
def _positional(network: nn.Module, names: Sequence[str]) -> Iterator[None]:
    """Gives ``forward(**inputs)`` a parameter for each name, without which torch's exporter mixes up the names."""

    def forward(*tensors: Tensor) -> Any:
        """What the network computes."""
        return type(network).forward(network, **dict(zip(names, tensors, strict=True)))

    parameters = [inspect.Parameter(name, inspect.Parameter.POSITIONAL_OR_KEYWORD) for name in names]
    forward.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    network.forward = forward
    try:
        yield
    finally:
        del network.forward


def _check(model: onnx.ModelProto) -> None:
    """The export keeps what the contract promises."""
    onnx.checker.check_model(model)
    found = {node.op_type for graph in (model.graph, *model.functions) for node in graph.node} & _RANDOM
    opset = max(item.version for item in model.opset_import if item.domain in ("", "ai.onnx"))
    assert not found, f"random operators {found}"
    assert opset <= OPSET, f"opset {opset}"

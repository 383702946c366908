"""AtlasNet to ONNX: an encoder and a decoder file with their metadata."""

from __future__ import annotations

import json
import os
import tempfile
import warnings
from pathlib import Path

import numpy as np
import torch
from torch import nn

from ..meshes.networks import CONTRACT, DECODER_FILE, ENCODER_FILE
from .atlasnet import FEATURE_WIDTH, AtlasNet

OPSET = 18
IR_VERSION = 10


def export(network: AtlasNet, folder: str | Path, provenance: dict) -> list[Path]:
    """Write ``atlasnet_encoder.onnx`` and ``atlasnet_decoder.onnx`` into a folder and return their paths.

    The encoder's batch norms are folded into its layers and the weights stored as
    float16 (computing stays float32). ``provenance`` goes as JSON into the files'
    metadata, with the version of the contract that the library checks on loading.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    encoder = network.eval().encoder.folded().eval()
    points, feature, sphere = torch.zeros(2, 64, 3), torch.zeros(2, FEATURE_WIDTH), torch.zeros(48, 3)
    batch, count = torch.export.Dim("batch"), torch.export.Dim("points")
    _write(encoder, (points,), ({0: batch, 1: count},), ("points",), "feature", folder / ENCODER_FILE, provenance)
    shapes = ({0: batch}, {0: count})
    _write(
        network.decoder, (feature, sphere), shapes, ("feature", "sphere"), "points", folder / DECODER_FILE, provenance
    )
    return [folder / ENCODER_FILE, folder / DECODER_FILE]


def _write(
    module: nn.Module,
    inputs: tuple[torch.Tensor, ...],
    shapes: tuple[dict, ...],
    names: tuple[str, ...],
    output: str,
    path: Path,
    provenance: dict,
) -> None:
    import onnx

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        program = torch.onnx.export(
            module, inputs, dynamo=True, opset_version=OPSET, dynamic_shapes=shapes, input_names=list(names),
            output_names=[output], verbose=False,
        )  # fmt: skip
    assert program is not None
    model = program.model_proto
    model.ir_version = min(model.ir_version, IR_VERSION)
    _store_as_float16(model)
    onnx.helper.set_model_props(model, {"unisg_contract": CONTRACT, "unisg_provenance": json.dumps(provenance)})
    onnx.checker.check_model(model)
    with tempfile.NamedTemporaryFile(dir=path.parent, suffix=".tmp", delete=False) as file:
        file.write(model.SerializeToString())
    os.replace(file.name, path)


def _store_as_float16(model: object) -> None:
    """Weights of more than 1,000 numbers as float16, cast back to float32 when the model is loaded."""
    import onnx
    from onnx import TensorProto, numpy_helper

    graph = model.graph  # type: ignore[attr-defined]
    for tensor in list(graph.initializer):
        values = numpy_helper.to_array(tensor)
        if values.dtype != np.float32 or values.size <= 1000:
            continue
        name = tensor.name
        tensor.CopyFrom(numpy_helper.from_array(values.astype(np.float16), f"{name}_half"))
        cast = onnx.helper.make_node("Cast", [f"{name}_half"], [name], to=TensorProto.FLOAT)
        graph.node.insert(0, cast)

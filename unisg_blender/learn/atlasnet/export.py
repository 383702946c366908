"""AtlasNet to ONNX: an encoder and a decoder file with their metadata."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import torch

from ...meshes.atlasnet_sessions import CONTRACT, DECODER_FILE, ENCODER_FILE, FEATURE_WIDTH, TASK
from ...runtime.atomic_files import write_file
from ...runtime.onnx_session import metadata_text
from ..onnx_export import export_onnx
from .network import AtlasNet

SMALLEST_HALVED = 1000
"""Weights of fewer numbers stay float32."""


def export(network: AtlasNet, folder: str | Path, provenance: dict[str, Any]) -> list[Path]:
    """Write ``atlasnet_encoder.onnx`` and ``atlasnet_decoder.onnx`` into a folder and return their paths.

    The encoder's batch norms are folded into its layers and the weights stored as
    float16 (computing stays float32). ``provenance`` goes into the files'
    metadata, with the version of the contract that the library checks on loading.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / ENCODER_FILE, folder / DECODER_FILE]
    points, feature = torch.zeros(2, 64, 3), torch.zeros(2, FEATURE_WIDTH)
    sphere, patch = torch.ones(2, 48, 3), torch.zeros(2, 48, dtype=torch.long)
    export_onnx(
        network.encoder.eval().folded(), {"points": points}, ["feature"], {"points": {0: "batch", 1: "points"}},
        metadata_text(TASK, CONTRACT, kind="encoder", provenance=provenance), paths[0],
    )  # fmt: skip
    export_onnx(
        network.decoder, {"feature": feature, "sphere": sphere, "patch": patch}, ["points"],
        {"feature": {0: "batch"}, "sphere": {0: "batch", 1: "points"}, "patch": {0: "batch", 1: "points"}},
        metadata_text(TASK, CONTRACT, kind="decoder", provenance=provenance, patches=network.decoder.patches), paths[1],
    )  # fmt: skip
    for path in paths:
        _halve_weights(path)
    return paths


def _halve_weights(path: Path) -> None:
    """Store an ONNX file's large weights as float16, cast back to float32 when the model is loaded."""
    import onnx
    from onnx import TensorProto, numpy_helper

    model = onnx.load(str(path))
    for tensor in list(model.graph.initializer):
        values = numpy_helper.to_array(tensor)
        if values.dtype != np.float32 or values.size < SMALLEST_HALVED:
            continue
        name = tensor.name
        tensor.CopyFrom(numpy_helper.from_array(values.astype(np.float16), f"{name}_half"))
        model.graph.node.insert(0, onnx.helper.make_node("Cast", [f"{name}_half"], [name], to=TensorProto.FLOAT))
    onnx.checker.check_model(model)
    write_file(path, model.SerializeToString())

"""The AtlasNet networks."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from ..runtime.onnx_session import OnnxModel, open_model

ENCODER_FILE = "atlasnet_encoder.onnx"
DECODER_FILE = "atlasnet_decoder.onnx"
FEATURE_WIDTH = 1024
CONTRACT = 2
TASK = "atlasnet"


@lru_cache(maxsize=4)
def load_network(path: Path, threads: int = 1) -> OnnxModel:
    """A network on ``threads`` cores; the same file is loaded once.

    Raises
    ------
    UniSGError
        If the file is missing, no ONNX model, or not of this library's AtlasNet contract.
    """
    return open_model(path, TASK, (CONTRACT,), "meshes", threads)

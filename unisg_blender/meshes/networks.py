"""The AtlasNet networks as onnxruntime sessions."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Any

from ..errors import UniSGError

PRETRAINED = Path(__file__).parent.parent / "pretrained"
ENCODER_FILE = "atlasnet_encoder.onnx"
DECODER_FILE = "atlasnet_decoder.onnx"
CONTRACT = "unisg-atlasnet-1"
FEATURE_WIDTH = 1024


@lru_cache(maxsize=4)
def load_network(path: Path, threads: int = 1) -> Any:
    """An onnxruntime session on ``threads`` cores; the same file is loaded once.

    Raises
    ------
    UniSGError
        If the file is missing, no ONNX model, or not of this library's AtlasNet contract.
    """
    import onnxruntime

    if not path.is_file():
        raise UniSGError(f"{path}: no such model file; 'unisg train meshes' makes one")
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    options.log_severity_level = 3
    try:
        session = onnxruntime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])
    except Exception as error:  # onnxruntime has no common class of errors
        raise UniSGError(f"{path}: cannot be loaded as a model: {error}") from error
    found = session.get_modelmeta().custom_metadata_map.get("unisg_contract", "none")
    if found != CONTRACT:
        raise UniSGError(f"{path}: is for contract {found!r}, this library needs {CONTRACT!r}: train it again")
    return session

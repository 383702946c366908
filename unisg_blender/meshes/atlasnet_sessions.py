"""The AtlasNet networks as onnxruntime sessions."""

from __future__ import annotations

import json
from functools import lru_cache
from pathlib import Path
from typing import Any

from ..errors import UniSGError
from ..runtime.onnx_session import KEY, open_session

PRETRAINED = Path(__file__).parent.parent / "pretrained"
ENCODER_FILE = "atlasnet_encoder.onnx"
DECODER_FILE = "atlasnet_decoder.onnx"
FEATURE_WIDTH = 1024
CONTRACT = 2
TASK = "atlasnet"


@lru_cache(maxsize=4)
def load_network(path: Path, threads: int = 1) -> Any:
    """An onnxruntime session on ``threads`` cores; the same file is loaded once.

    Raises
    ------
    UniSGError
        If the file is missing, no ONNX model, or not of this library's AtlasNet contract.
    """
    missing = f"{path}: no such model file; 'unisg train meshes' makes one"
    session, text = open_session(path, missing, threads)
    _check(text or "{}", path)
    return session


def patch_count(session: Any) -> int:
    """How many sphere patches a decoder has."""
    return int(json.loads(session.get_modelmeta().custom_metadata_map[KEY])["patches"])


def _check(metadata: str, path: Path) -> None:
    try:
        record = json.loads(metadata)
        task, contract = record.get("task"), record.get("contract")
    except (ValueError, AttributeError):
        raise UniSGError(f"{path}: the model's metadata is damaged: train it again") from None
    if task != TASK:
        raise UniSGError(f"{path} is a model for {task!r}, not one from 'unisg train meshes'")
    if contract != CONTRACT:
        raise UniSGError(f"{path} has contract {contract}, this software knows {CONTRACT}: update it or train again")

"""Trained networks: "topology" says which object stands on which, "classifier" what kind of scene it is."""

from __future__ import annotations

import os

from ..pretrained import FOLDER
from ..runtime.onnx_session import OnnxModel, open_model

VERSION = 1


def load_network(task: str, path: str | os.PathLike[str] | None = None, threads: int = 1) -> OnnxModel:
    """Open a network for "topology" or "classifier"; the shipped one when ``path`` is omitted.

    Raises
    ------
    UniSGError
        If the file is missing, no ONNX file, or without a contract for that task.
    """
    return open_model(FOLDER / f"{task}.onnx" if path is None else path, task, (VERSION,), task, threads)

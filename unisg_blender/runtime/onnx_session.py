"""The one way to open an ONNX file, whatever network it holds."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from ..errors import UniSGError

KEY = "unisg"
"""Name of the entry in a file's metadata that says what the network is."""


def open_session(path: str | os.PathLike[str], missing: str, threads: int = 1) -> tuple[Any, str | None]:
    """An onnxruntime session on ``threads`` cores, and the text that stands under :data:`KEY` in its metadata.

    Raises
    ------
    UniSGError
        If there is no such file (``missing`` is the message), or it is no ONNX file.
    """
    import onnxruntime

    file = Path(path)
    if not file.is_file():
        raise UniSGError(missing)
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    options.log_severity_level = 3
    try:
        session = onnxruntime.InferenceSession(str(file), options, providers=["CPUExecutionProvider"])
    except Exception as error:  # onnxruntime has no common base class for its errors
        reason = str(error).strip().splitlines()[0][:120]
        raise UniSGError(f"{file} is no ONNX model that can be run ({reason}): give another file") from None
    return session, session.get_modelmeta().custom_metadata_map.get(KEY)

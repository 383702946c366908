"""The one way to open a trained network: an ONNX file whose metadata say what it is for."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError
from .json_records import parse_json

KEY = "unisg"
"""Name of the entry in a file's metadata that says what the network is."""

EXTERNAL_DATA = re.compile(rb"(\x08|\x88\x80*\x00)location")
"""How ONNX files name files that keep their weights: a key of eight characters, in either way to write that length."""


class OnnxModel:
    """An opened network: its ``path``, its ``metadata``, and the version of the ``contract`` that they follow."""

    def __init__(self, path: Path, metadata: dict[str, Any], contract: int, session: Any) -> None:
        import onnxruntime

        self.path, self.metadata, self.contract, self._session = path, metadata, contract, session
        self._blank = {item.name: _blank(item) for item in session.get_inputs()}
        self._options = onnxruntime.RunOptions()
        self._options.only_execute_path_to_fetches = True

    def run(self, outputs: Sequence[str] | None = None, /, **inputs: NDArray[Any]) -> list[NDArray[np.float32]]:
        """The named outputs, all if omitted, for the given inputs.

        What the network does not use is left out; what the outputs do not depend on may be missing.

        Raises
        ------
        UniSGError
            If an output is not a number.
        """
        known = {name: value for name, value in inputs.items() if name in self._blank}
        found: list[NDArray[np.float32]] = self._session.run(outputs, self._blank | known, self._options)
        if any(np.isnan(values).any() for values in found):
            raise UniSGError(f"{self.path} gives no finite numbers: the model is damaged; train it again")
        return found


def _blank(item: Any) -> NDArray[Any]:
    """The smallest input of an ONNX input's kind."""
    shape = [size if isinstance(size, int) else 1 for size in item.shape]
    return np.zeros(shape, np.int64 if "int64" in item.type else np.float32)


def open_model(
    path: str | os.PathLike[str], task: str, contracts: Collection[int], job: str, threads: int = 1
) -> OnnxModel:
    """Open a network for a task.

    Parameters
    ----------
    contracts
        Versions of the task's metadata that this software knows.
    job
        The training that makes such a network: ``unisg train JOB``.
    threads
        Cores that it computes on.

    Raises
    ------
    UniSGError
        If the file is missing, no ONNX model, keeps weights in other files, or has no metadata of a known version for
        that task. Operators that onnxruntime does not bring along are refused by onnxruntime.
    """
    import onnxruntime

    file = Path(path)
    if not file.is_file():
        raise UniSGError(f"there is no model {file}: train one with 'unisg train {job}', or give another path")
    data = file.read_bytes()
    if EXTERNAL_DATA.search(data):
        raise UniSGError(f"{file} keeps its weights in other files, which are not opened: save it as one file")
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    options.log_severity_level = 3
    try:
        session = onnxruntime.InferenceSession(data, options, providers=["CPUExecutionProvider"])
    except Exception as error:  # onnxruntime has no common base class for its errors
        reason = str(error).strip().splitlines()[0][:120]
        raise UniSGError(f"{file} is no ONNX model that can be run ({reason}): give another file") from None
    text = session.get_modelmeta().custom_metadata_map.get(KEY)
    if text is None:
        raise UniSGError(f"{file} is another ONNX model, it has no UniSG metadata: give one from 'unisg train {job}'")
    return OnnxModel(file, *read_metadata(text, file, task, contracts, job), session)


def metadata_text(task: str, contract: int, **entries: Any) -> str:
    """The entry for the metadata of a network, JSON."""
    return json.dumps({"contract": contract, "task": task, **entries}, ensure_ascii=False, sort_keys=True)


def read_metadata(text: str, path: Path, task: str, contracts: Collection[int], job: str) -> tuple[dict[str, Any], int]:
    """The entries and the contract that :func:`metadata_text` was given.

    Raises
    ------
    UniSGError
        If they are damaged, for another task or of another version.
    """
    try:
        record = dict(parse_json(text, str(path)))
        version, found = record.pop("contract"), record.pop("task")
    except (UniSGError, ValueError, KeyError, TypeError):
        raise damaged(path) from None
    if found != task:
        raise UniSGError(f"{path} is a model for {found!r}: give one from 'unisg train {job}'")
    if version not in contracts:
        known = max(contracts)
        raise UniSGError(f"{path} has contract {version}, this software knows {known}: update it or train again")
    return record, version


def damaged(path: Path) -> UniSGError:
    """The error for metadata without what belongs there."""
    return UniSGError(f"{path}: the model's metadata is damaged: train it again")

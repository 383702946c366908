"""A trained model: an ONNX file, its contract, and the assets beside it."""

from __future__ import annotations

import os
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...dataset.assets.asset_file import AssetFile
from ...errors import UniSGError
from ...runtime.onnx_session import open_session
from ..observe.contract import Contract

ASSETS_SUFFIX = ".assets.safetensors"


class TrainedModel:
    """An opened model; :meth:`run` computes its outputs."""

    def __init__(self, path: Path, session: Any, contract: Contract) -> None:
        self.path = path
        self.contract = contract
        self._session = session
        self._options = _only_what_is_asked()
        self._blank = {item.name: _blank(item) for item in session.get_inputs()}

    def run(self, outputs: list[str], **inputs: NDArray[Any]) -> list[NDArray[np.float32]]:
        """The named outputs for the given inputs.

        What the network does not use is left out; what the outputs do not depend on may be missing.
        """
        given = {name: value for name, value in inputs.items() if name in self._blank}
        return self._session.run(outputs, self._blank | given, self._options)

    @cached_property
    def assets(self) -> AssetFile | None:
        """The assets file beside the model, None if there is none."""
        path = assets_path(self.path)
        return AssetFile(path) if path.is_file() else None


def _only_what_is_asked() -> Any:
    """Run options that leave out what the outputs asked for do not need."""
    import onnxruntime

    options = onnxruntime.RunOptions()
    options.only_execute_path_to_fetches = True
    return options


def _blank(item: Any) -> NDArray[Any]:
    """The smallest input of an ONNX input's kind."""
    shape = [size if isinstance(size, int) else 1 for size in item.shape]
    return np.zeros(shape, np.int64 if "int64" in item.type else np.float32)


def assets_path(model: Path) -> Path:
    """Where the assets of a model are: ``room.onnx`` has ``room.assets.safetensors``."""
    return model.with_suffix(ASSETS_SUFFIX)


def load_model(path: str | os.PathLike[str], threads: int = 1) -> TrainedModel:
    """Open a model and check its contract.

    Raises
    ------
    UniSGError
        If the file is missing, no ONNX file, without a contract, or of another contract or task.
    """
    file = Path(path)
    missing = f"there is no model {file}: train one with 'unisg train cgvae', or give another path"
    session, text = open_session(file, missing, threads)
    if text is None:
        raise UniSGError(f"{file} is an ONNX model of another kind: it has no UniSG metadata; use 'unisg train'")
    return TrainedModel(file, session, Contract.from_json(text, file))

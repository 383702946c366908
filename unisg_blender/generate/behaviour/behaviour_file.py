"""Opens the behaviour beside a generator's model."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import UniSGError
from ...runtime.onnx_session import open_session
from .action_kinds import Kinds
from .network_policy import OUTPUTS, NetworkPolicy


def load_behaviour(path: Path, threads: int = 1) -> NetworkPolicy:
    """The behaviour of a file that ``unisg train cgvae`` wrote.

    Raises
    ------
    UniSGError
        If the file is missing, no ONNX file, or no model of behaviour that this software knows.
    """
    missing = f"there is no behaviour {path}: 'unisg train cgvae' writes it beside the model"
    session, text = open_session(path, missing, threads)
    if text is None:
        raise UniSGError(f"{path} is an ONNX model of another kind: it has no UniSG metadata; use 'unisg train'")

    names = {item.name for item in session.get_inputs()}

    def run(inputs: dict[str, NDArray[Any]]) -> list[NDArray[np.float32]]:
        """The network's outputs for those inputs that the file has."""
        found: list[NDArray[np.float32]] = session.run(
            list(OUTPUTS), {name: array for name, array in inputs.items() if name in names}
        )
        return found

    return NetworkPolicy(Kinds.from_json(text, path), run)

"""Trained networks that predict, as onnxruntime sessions with a contract in their metadata."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import UniSGError
from ..runtime.onnx_session import open_session

VERSION = 1
PRETRAINED = Path(__file__).parent.parent / "pretrained"
TASKS = {"topology": "which thing stands on which", "classifier": "what kind of scene it is"}
"""What there are networks for; ``unisg train TASK`` makes one, ``pretrained/TASK.onnx`` is the shipped one."""


@dataclass(frozen=True, eq=False)
class Network:
    """An opened network: :meth:`run` computes its outputs, ``metadata`` is its contract."""

    path: Path
    metadata: dict[str, Any]
    session: Any

    def run(self, **inputs: NDArray[Any]) -> list[NDArray[np.float32]]:
        """All outputs; inputs that the network does not use are left out."""
        known = {item.name for item in self.session.get_inputs()}
        return self.session.run(None, {name: value for name, value in inputs.items() if name in known})


def write_metadata(task: str, **entries: Any) -> str:
    """The contract of a network as JSON."""
    return json.dumps({"contract": VERSION, "task": task, **entries}, ensure_ascii=False, sort_keys=True)


def load_network(task: str, path: str | os.PathLike[str] | None = None, threads: int = 1) -> Network:
    """Open a network for one of :data:`TASKS`; the shipped one when ``path`` is omitted.

    Raises
    ------
    UniSGError
        If the file is missing, no ONNX file, or without a contract for that task.
    """
    file = PRETRAINED / f"{task}.onnx" if path is None else Path(path)
    missing = f"there is no model {file}: train one with 'unisg train {task}', or give another path"
    session, text = open_session(file, missing, threads)
    return Network(file, _contract(text, task, file), session)


def _contract(text: str | None, task: str, file: Path) -> dict[str, Any]:
    try:
        record = json.loads(text or "")
        found, version = record["task"], record["contract"]
    except (ValueError, KeyError, TypeError):
        raise UniSGError(f"{file} has no UniSG metadata: train it with 'unisg train {task}'") from None
    if found != task:
        raise UniSGError(f"{file} is a model for {found!r}: give one from 'unisg train {task}' ({TASKS[task]})")
    if version != VERSION:
        raise UniSGError(f"{file} has contract {version}, this software knows {VERSION}: update it or train again")
    return record

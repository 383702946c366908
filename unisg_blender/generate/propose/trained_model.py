"""A trained generator: an ONNX file, its contract, and the assets beside it."""

from __future__ import annotations

import os
from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...dataset.assets.asset_file import AssetFile
from ...errors import UniSGError
from ...runtime.onnx_session import OnnxModel, open_model
from ..observe.contract import KINDS, SINCE, TASK, VERSION, Contract

ASSETS_SUFFIX = ".assets.safetensors"


@dataclass(frozen=True, eq=False)
class TrainedModel:
    """A model's ``contract`` and its ``network``, which one that proposes by other means does not need."""

    path: Path
    contract: Contract
    network: OnnxModel | None = None

    def run(self, outputs: list[str], **inputs: NDArray[Any]) -> list[NDArray[np.float32]]:
        """The named outputs of the network, see :meth:`~....runtime.onnx_session.OnnxModel.run`."""
        assert self.network is not None
        return self.network.run(outputs, **inputs)

    @cached_property
    def assets(self) -> AssetFile | None:
        """The assets file beside the model, None if there is none."""
        path = assets_path(self.path)
        return AssetFile(path) if path.is_file() else None


def assets_path(model: Path) -> Path:
    """Where the assets of a model are: ``room.onnx`` has ``room.assets.safetensors``."""
    return model.with_suffix(ASSETS_SUFFIX)


def load_model(path: str | os.PathLike[str], threads: int = 1, kinds: Collection[str] = KINDS) -> TrainedModel:
    """Open a model of one of some kinds and check its contract.

    Raises
    ------
    UniSGError
        If the file is missing, no ONNX file, without a contract, or of another contract, task or kind.
    """
    network = open_model(path, TASK, range(1, VERSION + 1), "cgvae", threads)
    contract = Contract.from_record(network.metadata, network.path)
    if contract.kind not in kinds:
        raise UniSGError(f"{path} is a model of kind {contract.kind!r}: give one from 'unisg train cgvae'")
    if network.contract < SINCE.get(contract.kind, 1):
        raise UniSGError(f"{path} was trained for an older version of this software: train it again")
    if contract.latent:
        network.expect("noise" if contract.kind == "cgvae" else "latent", contract.latent)
    return TrainedModel(network.path, contract, network)

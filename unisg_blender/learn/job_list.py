"""What ``unisg train`` can train, by name. Needs no torch before a job is loaded."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import MissingPackageError
from .hyperparameters import Settings

if TYPE_CHECKING:
    from ..dataset.format.reader import Dataset

PACKAGES = ("torch", "torch_geometric", "pytorch_lightning", "onnx", "onnxscript")


@dataclass(frozen=True)
class Job:
    """What a job trains: a model of this room, with ``--paper`` another, and what stands beside it.

    ``several``: it learns from several datasets together; ``alone``: on one device, whatever is asked for.
    """

    text: str
    model: str
    paper: str = ""
    several: bool = False
    behaviour: bool = False
    alone: bool = False


JOBS = {
    "cgvae": Job(
        "a generator of objects for scenes: conditional graph variational autoencoder",
        model="anchors", paper="cgvae", behaviour=True,
    ),
    "atiss": Job(
        "an autoregressive set model at small size, a baseline for 'unisg evaluate --also'", model="atiss", alone=True
    ),
    "topology": Job("which thing stands on which, from datasets with relations", model="topology", several=True),
    "classifier": Job(
        "what kind of scene it is, from datasets with labels, or one dataset per kind",
        model="scene_classifier", several=True,
    ),
    "meshes": Job("the mesh feature (AtlasNet) and the model of categories, from folders of mesh files", "atlasnet"),
}  # fmt: skip
"""What can be trained. All but "meshes", which has :mod:`..commands.train_meshes`, learn from datasets."""


def load(module: str) -> Any:
    """A module of this room, such as "anchors.training".

    Raises
    ------
    MissingPackageError
        Without the packages of the extra "learn".
    """
    try:
        return importlib.import_module(f".{module}", __package__)
    except ModuleNotFoundError as error:
        if error.name and error.name.split(".")[0] in PACKAGES:
            raise MissingPackageError(error.name, "learn") from None
        raise


def train(name: str, datasets: Sequence[Dataset], out: Path, settings: Settings) -> dict[str, Any]:
    """Do one of :data:`JOBS` that learn from datasets; returns the provenance that the model carries.

    Raises
    ------
    UniSGError
        See :func:`.training_job.train_model`.
    """
    job = JOBS[name]
    settings = replace(settings, devices=1, nodes=1) if job.alone else settings
    module = load(f"{job.paper if settings.paper and job.paper else job.model}.training")
    source: dict[str, Any] = load("training_job").train_model(module, datasets, out, settings)
    if not job.behaviour:
        return source
    behaviour = load("behaviour.training").train_beside(datasets, out, settings)
    notes = [*source["notes"], *behaviour["notes"]]
    return {**source, "notes": list(dict.fromkeys(notes)), "behaviour": behaviour}

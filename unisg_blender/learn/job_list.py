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

PACKAGES = ("torch", "torch_geometric", "pytorch_lightning", "onnx", "onnxscript", "sklearn")

FEW_ROOMS = 150
"""Up to so many rooms trees are trained, unless epochs or the like are asked for."""


@dataclass(frozen=True)
class Job:
    """What a job trains: a model of this room, with ``--paper`` another, of ``few`` rooms a third, what stands beside.

    ``several``: it learns from several datasets together; ``alone``: on one device, whatever is asked for.
    """

    text: str
    model: str
    paper: str = ""
    few: str = ""
    several: bool = False
    behaviour: bool = False
    alone: bool = False


JOBS = {
    "cgvae": Job(
        "a generator of objects for scenes: conditional graph variational autoencoder",
        model="anchors", paper="cgvae", few="trees", behaviour=True,
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


def takes_few(dataset: Dataset, settings: Settings) -> bool:
    """Whether rooms are so few that trees learn more of them, and nothing was asked for that only networks have."""
    asked = settings.paper or settings.epochs or settings.form or settings.patience or settings.logs
    return not asked and len(dataset) <= FEW_ROOMS


def train(name: str, datasets: Sequence[Dataset], out: Path, settings: Settings) -> dict[str, Any]:
    """Do one of :data:`JOBS` that learn from datasets; returns the provenance that the model carries.

    Raises
    ------
    UniSGError
        See :func:`.training_job.train_model`.
    """
    job = JOBS[name]
    settings = replace(settings, devices=1, nodes=1) if job.alone else settings
    if job.few and takes_few(datasets[0], settings):
        source: dict[str, Any] = load(f"{job.few}.training").train_trees(datasets, out, settings)
    else:
        module = load(f"{job.paper if settings.paper and job.paper else job.model}.training")
        source = load("training_job").train_model(module, datasets, out, settings)
    if not job.behaviour:
        return source
    behaviour = load("behaviour.training").train_beside(datasets, out, settings)
    notes = [*source["notes"], *behaviour["notes"]]
    return {**source, "notes": list(dict.fromkeys(notes)), "behaviour": behaviour}

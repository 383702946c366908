"""Trains AtlasNet on folders of meshes and exports encoder and decoder to ONNX."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from ...errors import UniSGError
from ...meshes.shape_feature import cloud
from ...meshes.shape_files import ShapeFile
from ..hyperparameters import accelerator_device
from ..losses.chamfer import chamfer
from .network import AtlasNet

POOL = 4096
"""Points kept of every model; each step draws its own from them."""


@dataclass(frozen=True)
class MeshTraining:
    """Settings of a training run; the same ones with the same meshes give the same networks on one thread.

    The encoder sees ``points`` of a surface; ``targets`` of it are compared with
    ``drawn`` points of the decoded patches. ``jitter`` is in units of the unit
    sphere; ``stretch`` the largest factor by which one axis is scaled; ``tumbled``
    the share of samples turned about any axis, ``turned`` that of those turned by
    any angle about the vertical one: the others are turned by quarters.
    """

    steps: int = 1800
    batch: int = 16
    points: int = 192
    targets: int = 320
    drawn: int = 256
    rate: float = 1e-3
    jitter: float = 0.005
    stretch: float = 1.3
    tumbled: float = 0.05
    turned: float = 0.15
    patches: int = 16
    width: int = 64
    depth: int = 2
    seed: int = 0
    threads: int = 1
    accelerator: str = "auto"


def train(
    models: Sequence[ShapeFile],
    settings: MeshTraining,
    progress: Callable[[int, float], None] = lambda step, loss: None,
) -> tuple[AtlasNet, dict]:
    """Train on models; returns the network in evaluation mode and a report.

    Parameters
    ----------
    models
        All of them are trained on: choose the split before.
    settings
        See :class:`MeshTraining`.
    progress
        Called after each step with its number and loss.

    Raises
    ------
    UniSGError
        If there are no models, or one has no points.
    """
    if not models:
        raise UniSGError("no meshes to train on: give a folder of mesh files, or rooms to make")
    torch.set_num_threads(settings.threads)
    torch.manual_seed(settings.seed)
    generator = np.random.default_rng(settings.seed)
    clouds = [cloud(model.mesh, POOL, place) for place, model in enumerate(models)]
    families = _families(models)
    device = accelerator_device(settings.accelerator)
    network = AtlasNet(settings.patches, settings.width, settings.depth).to(device).train()
    optimiser = torch.optim.AdamW(network.parameters(), lr=settings.rate, weight_decay=1e-4)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, settings.rate, settings.steps + 1, pct_start=0.1)
    losses, start = [], time.perf_counter()
    for step in range(settings.steps):
        points = torch.from_numpy(_batch(clouds, families, settings, generator)).to(device)
        decoded = network(points[:, : settings.points], settings.drawn, generator)
        loss = chamfer(decoded, points[:, : settings.targets]).mean()
        optimiser.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(network.parameters(), 1.0)
        optimiser.step()
        schedule.step()
        losses.append(float(loss.detach()))
        progress(step, losses[-1])
    last = float(np.mean(losses[-max(1, len(losses) // 20) :]))
    told = {name: value for name, value in asdict(settings).items() if name != "accelerator"}
    report = {**told, "models": len(models), "families": len(families), "training_loss": last}
    return network.cpu().eval(), report | {"seconds": round(time.perf_counter() - start, 1)}


def _families(models: Sequence[ShapeFile]) -> list[list[int]]:
    """Model numbers by family, so that many variants of one object count as one object."""
    places: dict[str, list[int]] = {}
    for place, model in enumerate(models):
        places.setdefault(model.family, []).append(place)
    return list(places.values())


def _batch(
    clouds: Sequence[NDArray[np.float32]],
    families: Sequence[Sequence[int]],
    settings: MeshTraining,
    generator: np.random.Generator,
) -> NDArray[np.float32]:
    """Augmented points (batch, n, 3) in the unit sphere, as many as are needed."""
    count = max(settings.points, settings.targets)
    batch = np.empty((settings.batch, count, 3), np.float32)
    for row in range(settings.batch):
        family = families[generator.integers(len(families))]
        pool = clouds[family[generator.integers(len(family))]]
        chosen = pool[generator.choice(len(pool), count, replace=False)]
        batch[row] = augment(chosen, settings, generator)
    return batch


def augment(points: NDArray[np.float32], settings: MeshTraining, generator: np.random.Generator) -> NDArray[np.float32]:
    """Points (n, 3) mirrored, stretched, turned, brought into the unit sphere and jittered."""
    limit = np.log(settings.stretch)
    factors = np.exp(generator.uniform(-limit, limit, 3))
    factors[0] *= generator.choice([-1.0, 1.0])
    moved = (points - points.mean(axis=0)) * factors @ _turn(settings, generator).T
    moved -= moved.mean(axis=0)
    moved /= max(float(np.linalg.norm(moved, axis=1).max()), 1e-12)
    return (moved + generator.normal(0, settings.jitter, points.shape)).astype(np.float32)


def _turn(settings: MeshTraining, generator: np.random.Generator) -> NDArray[np.float64]:
    kind = generator.random()
    if kind < settings.tumbled:
        return random_rotation(generator)
    if kind < settings.tumbled + settings.turned:
        return yaw(generator.uniform(0, 2 * np.pi))
    return yaw(np.pi / 2 * generator.integers(4))


def yaw(angle: float) -> NDArray[np.float64]:
    """Rotation (3, 3) about the vertical axis by an angle in radians."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def random_rotation(generator: np.random.Generator) -> NDArray[np.float64]:
    """A rotation (3, 3), uniform over all of them."""
    q, r = np.linalg.qr(generator.standard_normal((3, 3)))
    q = q * np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else -q

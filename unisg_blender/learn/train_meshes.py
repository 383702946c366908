"""Trains AtlasNet on folders of meshes and exports encoder and decoder to ONNX."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass

import numpy as np
import torch
from numpy.typing import NDArray

from ..errors import UniSGError
from ..meshes.models import Model
from ..meshes.sampling import sample_surface
from .atlasnet import AtlasNet
from .chamfer import chamfer

POOL = 4096
"""Points kept of every model; each step draws its own from them."""


@dataclass(frozen=True)
class MeshTraining:
    """Settings of a training run; the same ones with the same meshes give the same networks on one thread.

    ``points`` of the surface are seen by the encoder and compared with ``targets``
    points of the sphere; ``jitter`` is in units of the unit sphere; ``stretch``
    the largest factor by which one axis is scaled; ``tumbled`` the share of
    samples turned about any axis and not only about the vertical one.
    """

    steps: int = 8000
    batch: int = 16
    points: int = 512
    targets: int = 320
    rate: float = 1e-3
    jitter: float = 0.005
    stretch: float = 1.3
    tumbled: float = 0.25
    width: int = 256
    depth: int = 4
    seed: int = 0
    threads: int = 1


def train(
    models: Sequence[Model], settings: MeshTraining, progress: Callable[[int, float], None] = lambda step, loss: None
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
        If there are no models.
    """
    if not models:
        raise UniSGError("no meshes to train on: give a folder of mesh files, or rooms to make")
    torch.set_num_threads(settings.threads)
    torch.manual_seed(settings.seed)
    generator = np.random.default_rng(settings.seed)
    clouds = [sample_surface(model.mesh, POOL, place).points for place, model in enumerate(models)]
    families = _families(models)
    network = AtlasNet(settings.width, settings.depth).train()
    optimiser = torch.optim.AdamW(network.parameters(), lr=settings.rate, weight_decay=1e-4)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, settings.rate, settings.steps + 1, pct_start=0.05)
    losses, start = [], time.perf_counter()
    for step in range(settings.steps):
        points = torch.from_numpy(_batch(clouds, families, settings, generator))
        template = torch.from_numpy(random_sphere(settings.targets, generator))
        loss = chamfer(network(points, template), points).mean()
        optimiser.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(network.parameters(), 1.0)
        optimiser.step()
        schedule.step()
        losses.append(float(loss.detach()))
        progress(step, losses[-1])
    last = float(np.mean(losses[-max(1, len(losses) // 20) :]))
    report = {**asdict(settings), "models": len(models), "families": len(families), "training_loss": last}
    return network.eval(), report | {"seconds": round(time.perf_counter() - start, 1)}


def random_sphere(count: int, generator: np.random.Generator) -> NDArray[np.float32]:
    """Uniform random points of the unit sphere, float32 (count, 3)."""
    points = generator.standard_normal((count, 3))
    return (points / np.linalg.norm(points, axis=1, keepdims=True)).astype(np.float32)


def _families(models: Sequence[Model]) -> list[list[int]]:
    """Model numbers by family, so that many variants of one thing count as one thing."""
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
    """Augmented points (batch, points, 3) in the unit sphere."""
    batch = np.empty((settings.batch, settings.points, 3), np.float32)
    for row in range(settings.batch):
        family = families[generator.integers(len(families))]
        cloud = clouds[family[generator.integers(len(family))]]
        chosen = cloud[generator.choice(len(cloud), settings.points, replace=False)]
        batch[row] = augment(chosen, settings, generator)
    return batch


def augment(points: NDArray[np.float32], settings: MeshTraining, generator: np.random.Generator) -> NDArray[np.float32]:
    """Points (n, 3) mirrored, stretched, turned, brought into the unit sphere and jittered."""
    limit = np.log(settings.stretch)
    factors = np.exp(generator.uniform(-limit, limit, 3))
    factors[0] *= generator.choice([-1.0, 1.0])
    turn = random_rotation(generator) if generator.random() < settings.tumbled else yaw(generator.uniform(0, 2 * np.pi))
    moved = (points - points.mean(axis=0)) * factors @ turn.T
    moved -= moved.mean(axis=0)
    moved /= max(float(np.linalg.norm(moved, axis=1).max()), 1e-12)
    return (moved + generator.normal(0, settings.jitter, points.shape)).astype(np.float32)


def yaw(angle: float) -> NDArray[np.float64]:
    """Rotation (3, 3) about the vertical axis by an angle in radians."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def random_rotation(generator: np.random.Generator) -> NDArray[np.float64]:
    """A rotation (3, 3), uniform over all of them."""
    q, r = np.linalg.qr(generator.standard_normal((3, 3)))
    q = q * np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else -q

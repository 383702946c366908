"""Experiment "poses": forms as targets, as inputs and as both, one factor at a time; errors in cm and degrees.

All seeds times all learning rates are trained side by side; for each form the rate with the best validation error
counts: every form has the same tuning budget.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from torch import Tensor

from ...dataset import open_dataset
from ...metrics.pose_errors import (
    decoded,
    folds_of,
    invalidity,
    r_squared,
    rotation_errors,
    summary,
    translation_errors,
)
from ...poses import FORMS
from ...scene.graph import SceneGraph
from ...worlds import WORLDS
from ..ensemble import StackedMlp, train_stacked

COUNTS = {"train": 2048, "validation": 128, "test": 512}
LANDMARKS = np.array([[0.3, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.25], [-0.1, -0.15, -0.2]])
"""Four points of an object without symmetry, metres: a pose as twelve coordinates that belong to no form."""

HIDDEN = {False: (64, 64, 64), True: (64, 64, 6, 64, 64)}
"""Widths of the layers; poses that go in and come out again pass six numbers, as many as a rigid pose has."""

TRANSLATION = {"small": 0.1, "medium": 1.0, "large": 10.0}
"""Standard deviation of each coordinate, metres."""

SCENES = ("relative", "absolute", "two poses", "composed")
"""Values of ``poses`` that stand for objects of operating rooms; the others are drawn at random."""


@dataclass(frozen=True, eq=False)
class Samples:
    """For each of G seeds and N poses: truth (G, N, 4, 4), the poses shown (G, N, P, 4, 4), symmetry (G, N)."""

    truth: NDArray[np.float64]
    shown: NDArray[np.float64]
    folds: NDArray[np.int64]


def run(settings: Mapping[str, Any], data: Path) -> dict[str, Any]:
    """One row: a form in one setting, all seeds.

    ``settings``: form; ``task``, which is "target" (landmarks in, form out), "input" (form in, landmarks out) or
    "both"; ``poses``, "full" or "yaw" rotations, or one of :data:`SCENES`; ``translation``; ``sign``, "canonical" or
    "random"; ``scaling``, "standard" or "raw" targets; ``seeds``, ``steps``, ``rates``.
    """
    seeds, form = list(range(settings["seeds"])), settings["form"]
    parts = {name: _samples(settings, name, len(seeds), data) for name in COUNTS}
    x = {name: _inputs(part, settings, 0) for name, part in parts.items()}
    y = {name: _outputs(part, settings, 1) for name, part in parts.items()}
    scale_x, scale_y = _Scale.of(x["train"], "standard"), _Scale.of(y["train"], settings.get("scaling", "standard"))
    rates = settings["rates"]
    each = [seed for seed in seeds for _ in rates]
    network = StackedMlp(len(scale_x.kept), len(scale_y.kept), each, HIDDEN[settings["task"] == "both"])
    together = (scale_x.apply(x["train"]), scale_y.apply(y["train"]))
    train_stacked(network, *together, rates * len(seeds), _mse, seeds, settings["steps"])
    raw = {name: _predict(network, scale_x.apply(x[name]), scale_y, len(rates)) for name in ("validation", "test")}
    errors = np.array(
        [_point_errors(raw["validation"][k], parts["validation"], k // len(rates), settings) for k in range(len(each))]
    )
    best = int(np.argmin(errors.reshape(len(seeds), len(rates)).mean(axis=0)))
    chosen = raw["test"][best :: len(rates)]
    rows = [_report(chosen[seed], parts["test"], y, seed, settings) for seed in seeds]
    constant = [np.broadcast_to(y["train"][seed].mean(axis=0), chosen[seed].shape) for seed in seeds]
    return {
        "parameters": network.parameters_each,
        "width": FORMS[form].width,
        "channels_learned": len(scale_y.kept) if settings["task"] != "input" else len(scale_x.kept),
        "rate": rates[best],
        "rows": rows,
        "predict_mean": [_report(constant[seed], parts["test"], y, seed, settings) for seed in seeds],
        "mse_of_zeros": float((y["test"] ** 2).mean()),
    }


def _samples(settings: Mapping[str, Any], part: str, seeds: int, data: Path) -> Samples:
    if settings["poses"] in SCENES:
        return _scene_samples(data / "rooms", part, seeds, settings["poses"])
    drawn = [_random_poses(settings, COUNTS[part], (seed, list(COUNTS).index(part))) for seed in range(seeds)]
    truth = np.stack(drawn)
    return Samples(truth, truth[:, :, None], np.ones(truth.shape[:2], np.int64))


def _random_poses(settings: Mapping[str, Any], count: int, seed: tuple[int, int]) -> NDArray[np.float64]:
    rng = np.random.default_rng(seed)
    poses = np.tile(np.eye(4), (count, 1, 1))
    turn = Rotation.random(count, random_state=int(rng.integers(2**31)))
    if settings["poses"] == "yaw":
        turn = Rotation.from_rotvec(np.outer(rng.uniform(-np.pi, np.pi, count), [0, 0, 1]))
    poses[:, :3, :3] = turn.as_matrix()
    poses[:, :3, 3] = rng.normal(0, TRANSLATION[settings["translation"]], (count, 3))
    return poses


@lru_cache(maxsize=1)
def _room_poses(folder: Path) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
    """World poses (K, 4, 4) of objects and of their parents, symmetry (K,) and room (K,)."""
    symmetry = _symmetries()
    world: list[NDArray[np.float64]] = []
    above: list[NDArray[np.float64]] = []
    folds: list[int] = []
    rooms: list[NDArray[np.int64]] = []
    for number, scene in enumerate(open_dataset(folder)):
        local, parent = FORMS["matrix"].encode(scene.local()).reshape(-1, 4, 4), scene.parent
        matrices: list[NDArray[np.float64]] = []
        for row, up in enumerate(parent.tolist()):
            matrices.append(local[row] if up < 0 else matrices[up] @ local[row])
        child = np.flatnonzero(parent >= 0)
        placed = np.stack(matrices)
        world.append(placed[child])
        above.append(placed[parent[child]])
        mesh = [bytes(value).hex() for value in scene["mesh.checksum"]]
        folds += [
            symmetry.get(mesh[scene["entity.mesh"][row]], 1) if scene["entity.mesh"][row] >= 0 else 1 for row in child
        ]
        rooms.append(np.full(len(child), number))
    return np.concatenate(world), np.concatenate(above), np.array(folds), np.concatenate(rooms)


@lru_cache(maxsize=1)
def _symmetries() -> dict[str, int]:
    """Symmetry by the mesh's checksum, of the meshes that 20 rooms use."""
    graphs: list[SceneGraph] = [WORLDS["operating-room"](seed) for seed in range(20)]
    meshes = {mesh.checksum: mesh for graph in graphs for mesh in graph.meshes}
    return {key: folds_of(mesh) for key, mesh in meshes.items()}


def _scene_samples(folder: Path, part: str, seeds: int, kind: str) -> Samples:
    """Objects drawn from rooms that no other part has."""
    world, above, folds, rooms = _room_poses(folder)
    ends = np.array([0.0, 0.7, 0.8, 1.0]) * (rooms.max() + 1)
    place = list(COUNTS).index(part)
    among = np.flatnonzero((rooms >= ends[place]) & (rooms < ends[place + 1]))
    rows = np.stack([np.random.default_rng((seed, place)).choice(among, COUNTS[part]) for seed in range(seeds)])
    local = np.linalg.solve(above, world)
    truth = (world if kind == "absolute" else local)[rows]
    shown = np.stack([above[rows], world[rows]], axis=2) if kind == "two poses" else truth[:, :, None]
    return Samples(truth, shown, folds[rows])


def _inputs(part: Samples, settings: Mapping[str, Any], salt: int) -> NDArray[np.float64]:
    if settings["task"] == "target":
        return landmarks(part.truth)
    return _written(part.shown, settings, salt).reshape(*part.truth.shape[:2], -1)


def _outputs(part: Samples, settings: Mapping[str, Any], salt: int) -> NDArray[np.float64]:
    return landmarks(part.truth) if settings["task"] == "input" else _written(part.truth, settings, salt)


def landmarks(poses: NDArray[np.float64]) -> NDArray[np.float64]:
    """Coordinates (..., 12) of :data:`LANDMARKS` under poses (..., 4, 4), metres."""
    points = np.einsum("...ij,kj->...ki", poses[..., :3, :3], LANDMARKS) + poses[..., None, :3, 3]
    return points.reshape(*poses.shape[:-2], -1)


def poses_of_landmarks(points: NDArray[np.floating]) -> NDArray[np.float64]:
    """The rigid poses (..., 4, 4) that bring :data:`LANDMARKS` nearest to points (..., 12) (Kabsch, 1976)."""
    found = np.float64(points).reshape(*points.shape[:-1], -1, 3)
    middle, own = found.mean(axis=-2), LANDMARKS.mean(axis=0)
    covariance = np.einsum("...ki,kj->...ij", found - middle[..., None, :], LANDMARKS - own)
    left, _, right = np.linalg.svd(covariance)
    left[..., :, 2] *= np.linalg.det(left @ right)[..., None]
    poses = np.zeros((*points.shape[:-1], 4, 4))
    poses[..., :3, :3], poses[..., 3, 3] = left @ right, 1
    poses[..., :3, 3] = middle - np.einsum("...ij,j->...i", poses[..., :3, :3], own)
    return poses


def _written(poses: NDArray[np.float64], settings: Mapping[str, Any], salt: int) -> NDArray[np.float64]:
    features = FORMS[settings["form"]].encode(poses)
    return random_signs(features, settings["form"], salt) if settings.get("sign") == "random" else features


def random_signs(features: NDArray[np.float64], form: str, seed: int) -> NDArray[np.float64]:
    """Each pose as one of the two features that mean it; forms with one feature per pose stay as they are."""
    sign = np.random.default_rng((seed, 5)).choice([-1.0, 1.0], features.shape[:-1])[..., None]
    result = features.copy()
    if form == "quaternion":
        result[..., 3:] *= sign
    elif form == "axis_angle":
        result[..., 3:4] = np.where(sign < 0, 2 * np.pi - features[..., 3:4], features[..., 3:4])
        result[..., 4:] *= sign
    elif form.startswith(("pga", "cga", "dual")):
        result *= sign
    return result


@dataclass(frozen=True, eq=False)
class _Scale:
    """Means and spreads (G, 1, C) of all channels, and the channels that vary."""

    mean: NDArray[np.float64]
    spread: NDArray[np.float64]
    kept: NDArray[np.int64]

    @staticmethod
    def of(values: NDArray[np.float64], scaling: str) -> _Scale:
        """From training values (G, N, C); "raw" leaves everything as it is."""
        mean, spread = values.mean(axis=1, keepdims=True), values.std(axis=1, keepdims=True)
        if scaling == "raw":
            return _Scale(np.zeros_like(mean), np.ones_like(spread), np.arange(values.shape[-1]))
        kept = np.flatnonzero((spread > 1e-6).all(axis=(0, 1)))
        return _Scale(mean, spread, kept)

    def apply(self, values: NDArray[np.float64]) -> Tensor:
        """Values (..., C) to scaled float32 ones (..., kept)."""
        scaled = (values - self.mean)[..., self.kept] / self.spread[..., self.kept]
        return torch.from_numpy(scaled.astype(np.float32))

    def undo(self, values: NDArray[np.float64], group: int) -> NDArray[np.float64]:
        """Scaled values (K, kept) of one group back to (K, C)."""
        whole = np.repeat(self.mean[group], len(values), axis=0)
        whole[:, self.kept] += values * self.spread[group][:, self.kept]
        return whole


def _mse(found: Tensor, wanted: Tensor) -> Tensor:
    return (found - wanted).square().mean(dim=(1, 2))


@torch.no_grad()
def _predict(network: StackedMlp, x: Tensor, scale: _Scale, each: int) -> list[NDArray[np.float64]]:
    found = network(x.repeat_interleave(each, dim=0)).double().numpy()
    return [scale.undo(values, number // each) for number, values in enumerate(found)]


def _poses(raw: NDArray[np.float64], settings: Mapping[str, Any]) -> NDArray[np.float64]:
    return poses_of_landmarks(raw) if settings["task"] == "input" else decoded(raw, settings["form"])


def _point_errors(raw: NDArray[np.float64], part: Samples, seed: int, settings: Mapping[str, Any]) -> float:
    """Median over poses of the mean distance of the landmarks, centimetres: what the learning rate is chosen by."""
    if not np.isfinite(raw).all():
        return np.inf
    apart = (landmarks(_poses(raw, settings)) - landmarks(part.truth[seed])).reshape(len(raw), -1, 3)
    return float(100 * np.median(np.linalg.norm(apart, axis=-1).mean(axis=-1)))


def _report(
    raw: NDArray[np.float64],
    part: Samples,
    y: Mapping[str, NDArray[np.float64]],
    seed: int,
    settings: Mapping[str, Any],
) -> dict[str, float]:
    poses, truth, wanted = _poses(raw, settings), part.truth[seed], y["test"][seed]
    report = {f"cm_{name}": value for name, value in summary(translation_errors(poses, truth)).items()}
    report |= {f"degrees_{name}": value for name, value in summary(rotation_errors(poses, truth)).items()}
    if settings["poses"] in SCENES:
        symmetric = summary(rotation_errors(poses, truth, part.folds[seed]))
        report |= {f"degrees_symmetric_{name}": value for name, value in symmetric.items()}
    report["points_cm"] = _point_errors(raw, part, seed, settings)
    report["mse"] = float(((raw - wanted) ** 2).mean())
    report["r_squared"] = r_squared(raw, wanted, y["train"][seed].mean(axis=0))
    if settings["task"] != "input":
        report["invalidity"] = invalidity(raw, settings["form"])
    return report

"""Exactness, speed and memory of the pose forms, and what keyframe reduction saves: measured in one run.

Every table is a list of flat rows. Times are processor time of one thread, medians
over repeats in which all contestants take turns, so that their ratios hold on a
busy machine too.
"""

from __future__ import annotations

import time
import tracemalloc
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from ...errors import MissingPackageError
from ...poses import FORMS, blend, compose, exp, from_multivector, sclerp, to_multivector
from ..reports import Table

CLIFFORD_SAMPLE = 300
MOTORS = ("pga", "cga", "cga_similarity")


def measure_poses(count: int, repeats: int, seed: int, progress: Callable[[str], None]) -> dict[str, Table]:
    """All tables of the benchmark.

    Parameters
    ----------
    count
        Poses in the speed measurements.
    repeats
        Rounds of which the median counts.
    seed
        Of the random poses.
    progress
        Called with the name of each step as it starts.

    Returns
    -------
    dict
        ``exactness``, ``agreement``, ``speed``, ``stretch_speed``, ``tensor_speed`` and ``memory``.

    Raises
    ------
    MissingPackageError
        Without threadpoolctl, which keeps every contestant to one thread.
    """
    try:
        from threadpoolctl import threadpool_limits  # type: ignore[import-untyped]
    except ImportError:
        raise MissingPackageError("threadpoolctl", "figures") from None
    steps: dict[str, Callable[[], Table]] = {
        "exactness": lambda: exactness(seed),
        "agreement": lambda: agreement(seed),
        "speed": lambda: speed(count, repeats, seed),
        "stretch_speed": lambda: stretch_speed(max(count // 5, 1), repeats, seed),
        "tensor_speed": lambda: tensor_speed(max(count // 5, 1), repeats, seed),
        "memory": lambda: memory(max(count // 5, 1), seed),
    }
    tables = {}
    with threadpool_limits(1):
        for name, step in steps.items():
            progress(name)
            tables[name] = step()
    return tables


def random_poses(count: int, seed: int, linear: str = "rigid") -> np.ndarray:
    """Matrices (count, 4, 4): uniform rotations, normal translations; ``linear`` rigid, scaled or general."""
    rng = np.random.default_rng(seed)
    quaternions = rng.normal(size=(count, 4))
    matrices = FORMS["quaternion"].decode(np.concatenate([rng.normal(size=(count, 3)), quaternions], axis=1))
    if linear == "scaled":
        matrices[:, :3, :3] *= np.exp(rng.normal(size=(count, 1, 1)))
    if linear == "general":
        matrices[:, :3, :3] = rng.normal(size=(count, 3, 3))
    return matrices


def difficult_poses(seed: int, linear: str) -> np.ndarray:
    """Random poses among every hard angle, axis, translation and (``general``) scale: 1,160 rigid, 23,200 general."""
    rng = np.random.default_rng(seed)
    axes = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [-1, 0, 1], [0, 1, -1], *rng.normal(size=(4, 3))])
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    angles = np.array([0, 1e-9, 1e-4, 0.5, np.pi / 2, np.pi - 1e-7, np.pi, np.pi + 1e-7, 2 * np.pi])
    hat = np.cross(np.eye(3), axes[:, None, :]).swapaxes(1, 2)
    sine, cosine = np.sin(angles), np.cos(angles)
    sine[angles == np.pi] = 0.0
    turns = (
        np.eye(3) + sine[:, None, None, None] * -hat.swapaxes(1, 2) + (1 - cosine)[:, None, None, None] * (hat @ hat)
    )
    turns = np.concatenate([turns.reshape(-1, 3, 3), random_poses(200, seed)[:, :3, :3]])
    if linear == "general":
        scale = np.array([-2.0, -1.0, 0.0, 1e-6, 0.1, 1.0, 3.0, 1e3])
        combinations = scale[rng.integers(0, len(scale), (20, 3))]
        turns = (turns[:, None] * combinations[:, None, :]).reshape(-1, 3, 3)
        turns = turns @ random_poses(len(turns), seed + 1)[:, :3, :3]
    matrices = np.tile(np.eye(4), (len(turns), 4, 1, 1))
    matrices[:, :, :3, :3] = turns[:, None]
    matrices[:, :, :3, 3] = rng.normal(size=(len(turns), 4, 3)) * np.array([0.0, 1e-6, 1.0, 1e6])[:, None]
    return matrices.reshape(-1, 4, 4)


def relative_errors(found: np.ndarray, expected: np.ndarray) -> tuple[float, float]:
    """Worst error of the linear block and of the translation, each relative to its own norm."""
    off = np.abs(found.astype(np.float64) - expected)
    linear = np.linalg.norm(expected[:, :3, :3], axis=(1, 2))
    translation = np.linalg.norm(expected[:, :3, 3], axis=1)
    block = off[:, :3, :3].max((1, 2)) / np.where(linear > 0, linear, 1)
    return float(block.max()), float((off[:, :3, 3].max(1) / np.where(translation > 0, translation, 1)).max())


def exactness(seed: int) -> Table:
    """Worst round-trip errors of every form over the difficult poses, in both precisions."""
    rows = []
    for kind, stretch in (("rigid", False), ("general", True)):
        poses = difficult_poses(seed, kind)
        for form in FORMS.values():
            row: dict[str, Any] = {"form": form.name, "poses": kind, "count": len(poses)}
            for dtype in (np.float64, np.float32):
                given = poses.astype(dtype)
                found = form.decode(form.encode(given, stretch=stretch), stretch=stretch)
                name = np.dtype(dtype).name
                row[f"linear_{name}"], row[f"translation_{name}"] = relative_errors(found, given.astype(np.float64))
            rows.append(row)
    return rows


def agreement(seed: int) -> Table:
    """Worst differences from ``clifford`` (products) and ``scipy`` (quaternions), and under factors."""
    from scipy.spatial.transform import Rotation

    poses = random_poses(2 * CLIFFORD_SAMPLE, seed)
    a, b = poses[:CLIFFORD_SAMPLE], poses[CLIFFORD_SAMPLE:]
    rows: Table = []
    for name in MOTORS:
        form = FORMS[name]
        product = to_multivector(form.encode(a), name) * to_multivector(form.encode(b), name)
        rows.append(
            {"check": f"{name}: clifford's product", "worst": _worst(form.decode(from_multivector(product)), a @ b)}
        )
    for form in FORMS.values():
        product = form.decode(compose(form.encode(a), form.encode(b), form.name))
        rows.append({"check": f"{form.name}: compose", "worst": _worst(product, a @ b)})
    quaternions = FORMS["quaternion"].encode(poses)[:, [4, 5, 6, 3]]
    turned = Rotation.from_matrix(poses[:, :3, :3]).as_quat(canonical=True)
    rows.append({"check": "quaternion: scipy", "worst": _worst(quaternions, turned)})
    for name in ("dual_quaternion", *MOTORS):
        features = FORMS[name].encode(poses)
        factors = [FORMS[name].project(k * features) for k in (1e-3, -1.0, 1e3)]
        rows.append({"check": f"{name}: project(k x)", "worst": max(_worst(x, features) for x in factors)})
    return rows


def speed(count: int, repeats: int, seed: int) -> Table:
    """Encoding and decoding rigid float64 matrices, one thread; ratios to scipy and to clifford."""
    from scipy.spatial.transform import Rotation

    poses = random_poses(count, seed)
    features = {name: form.encode(poses) for name, form in FORMS.items()}
    jobs: dict[str, Callable[[], Any]] = {
        "scipy from_matrix.as_quat": lambda: Rotation.from_matrix(poses[:, :3, :3]).as_quat()
    }
    for name, form in FORMS.items():
        jobs[f"{name} encode"] = partial(form.encode, poses)
        jobs[f"{name} decode"] = partial(form.decode, features[name])
    motors = features["dual_quaternion"]
    jobs["sclerp"] = partial(sclerp, motors, motors[::-1], 0.3)
    jobs["blend of 2"] = partial(
        blend, np.stack([motors, motors[::-1]], axis=1), np.broadcast_to([0.7, 0.3], (count, 2))
    )
    jobs["exp"] = partial(exp, np.random.default_rng(seed).normal(size=(count, 6)))
    rows = _timed(jobs, count, repeats)
    reference = rows[0]["nanoseconds"]
    one_by_one = _clifford_nanoseconds(poses[:CLIFFORD_SAMPLE])
    for row in rows:
        row["to_scipy"] = row["nanoseconds"] / reference
        row["faster_than_clifford"] = one_by_one / row["nanoseconds"]
    rows.append({"job": "clifford, one motor at a time", "nanoseconds": one_by_one, "to_scipy": one_by_one / reference})
    return rows


def stretch_speed(count: int, repeats: int, seed: int) -> Table:
    """Encoding affines with stretch beside numpy's batched 3x3 singular value decomposition alone."""
    general, scaled = random_poses(count, seed, "general"), random_poses(count, seed, "scaled")
    single = general.astype(np.float32)
    flat = general.copy()
    flat[:, :3, 2] = 0.0
    pga = FORMS["pga"]
    jobs: dict[str, Callable[[], Any]] = {
        "numpy.linalg.svd of the 3x3 blocks": lambda: np.linalg.svd(general[:, :3, :3]),
        "pga + stretch, general": lambda: pga.encode(general, stretch=True),
        "pga + stretch, general float32": lambda: pga.encode(single, stretch=True),
        "pga + stretch, uniform scale": lambda: pga.encode(scaled, stretch=True),
        "pga + stretch, rank 2": lambda: pga.encode(flat, stretch=True),
    }
    rows = _timed(jobs, count, repeats)
    for row in rows:
        row["to_svd"] = row["nanoseconds"] / rows[0]["nanoseconds"]
    return rows


def tensor_speed(count: int, repeats: int, seed: int) -> Table:
    """The same formulas on torch tensors, with and without gradients; empty without torch."""
    try:
        import torch
    except ImportError:
        return []
    rigid, pga, threads = random_poses(count, seed), FORMS["pga"], torch.get_num_threads()
    features = pga.encode(rigid)
    tensor, encoded = torch.tensor(rigid), torch.tensor(features)

    def gradient(function: Callable[[Any], Any], given: Any) -> Callable[[], Any]:
        """A call that differentiates the sum of a function of what is given."""
        return lambda: function(given.clone().requires_grad_()).sum().backward()

    jobs: dict[str, Callable[[], Any]] = {
        "arrays: pga encode": partial(pga.encode, rigid),
        "tensors: pga encode": partial(pga.encode, tensor),
        "tensors: pga encode and backward": gradient(pga.encode, tensor),
        "arrays: pga decode": partial(pga.decode, features),
        "tensors: pga decode": partial(pga.decode, encoded),
        "tensors: pga decode and backward": gradient(pga.decode, encoded),
        "arrays: pga project": partial(pga.project, features),
        "tensors: pga project": partial(pga.project, encoded),
        "tensors: pga project and backward": gradient(pga.project, encoded),
    }
    try:
        torch.set_num_threads(1)
        rows = _timed(jobs, count, repeats)
    finally:
        torch.set_num_threads(threads)
    for index, row in enumerate(rows):
        row["to_arrays"] = row["nanoseconds"] / rows[index // 3 * 3]["nanoseconds"]
    return rows


def memory(count: int, seed: int) -> Table:
    """Highest memory beside the input during a call, the result included, in copies of the input."""
    rows: Table = []
    for name, form in FORMS.items():
        for kind, stretch in (("rigid", False), ("general", True)):
            poses = random_poses(count, seed, kind)
            features = form.encode(poses, stretch=stretch)
            row: dict[str, Any] = {"form": name, "poses": kind}
            row["encode"] = _peak(partial(form.encode, poses, stretch)) / poses.nbytes
            row["decode"] = _peak(partial(form.decode, features, stretch)) / features.nbytes
            rows.append(row)
    return rows


def _worst(found: np.ndarray, expected: np.ndarray) -> float:
    return float(np.abs(found - expected).max())


def _timed(jobs: dict[str, Callable[[], Any]], count: int, repeats: int) -> Table:
    seconds: dict[str, list[float]] = {name: [] for name in jobs}
    for job in jobs.values():
        job()
    for _ in range(repeats):
        for name, job in jobs.items():
            start = time.process_time()
            job()
            seconds[name].append(time.process_time() - start)
    return [{"job": name, "nanoseconds": float(np.median(s)) / count * 1e9} for name, s in seconds.items()]


def _clifford_nanoseconds(poses: np.ndarray) -> float:
    """Median time to build one PGA motor T R with clifford's own operators."""
    from clifford.pga import blades as b

    times = []
    for tx, ty, tz, w, x, y, z in FORMS["quaternion"].encode(poses):
        start = time.process_time()
        rotor = w - z * b["e12"] + y * b["e13"] - x * b["e23"]
        _ = (1 - 0.5 * b["e0"] * (tx * b["e1"] + ty * b["e2"] + tz * b["e3"])) * rotor
        times.append(time.process_time() - start)
    return float(np.median(times)) * 1e9


def _peak(job: Callable[[], Any]) -> float:
    tracemalloc.start()
    try:
        result = job()
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    del result
    return float(peak)

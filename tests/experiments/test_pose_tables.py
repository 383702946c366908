"""The tables of the benchmark of poses: which poses, which errors, which ratios."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from unisg_blender.experiments.poses import poses_benchmark as benchmark
from unisg_blender.poses import FORMS

ANGLES = [0, 1e-9, 1e-4, 0.5, np.pi / 2, np.pi - 1e-7, np.pi, np.pi + 1e-7, 2 * np.pi]


def test_difficult_poses_have_every_angle_and_axis_at_every_distance() -> None:
    found = benchmark.difficult_poses(3, "rigid").reshape(-1, 4, 4, 4)
    assert len(found) == 9 * 10 + 200
    axes = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [-1, 0, 1], [0, 1, -1]])
    turns = found[:90, 0, :3, :3].reshape(9, 10, 3, 3)
    for angle, axis in itertools.product(range(9), range(6)):
        unit = axes[axis] / np.linalg.norm(axes[axis])
        expected = Rotation.from_rotvec(-ANGLES[angle] * unit).as_matrix()  # clockwise
        np.testing.assert_allclose(turns[angle, axis], expected, atol=1e-12)
    every = found[:, 0, :3, :3]
    np.testing.assert_allclose(every @ every.swapaxes(1, 2), np.tile(np.eye(3), (len(every), 1, 1)), atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(every), 1)
    assert np.linalg.matrix_rank(turns[3, 6:].reshape(4, 9)) == 4  # four axes more, drawn
    size = np.abs(found[:, :, :3, 3]).mean(axis=(0, 2))
    assert size[0] == 0
    np.testing.assert_allclose(size[1:] / [1e-6, 1, 1e6], 0.8, atol=0.1)
    np.testing.assert_array_equal(found[..., 3, :], np.broadcast_to([0, 0, 0, 1.0], (290, 4, 4)))


def test_general_ones_are_scaled_by_all_that_is_hard() -> None:
    found = benchmark.difficult_poses(3, "general")
    assert len(found) == 23_200
    singular = np.linalg.svd(found[::4, :3, :3], compute_uv=False)
    known = np.array([0.0, 1e-6, 0.1, 1.0, 2.0, 3.0, 1e3])
    off = np.abs(singular[..., None] - known).min(axis=-1)
    assert (off <= 1e-9 * np.maximum(singular, 1)).all()
    assert {float(known[np.abs(value - known).argmin()]) for value in np.unique(singular.round(7))} == set(known)


@pytest.mark.parametrize("linear", ["rigid", "scaled", "general"])
def test_random_poses_are_of_their_kind(linear: str) -> None:
    found = benchmark.random_poses(4000, 1, linear)
    gram = found[:, :3, :3] @ found[:, :3, :3].swapaxes(1, 2)
    scale = np.trace(gram, axis1=1, axis2=2) / 3
    uniform = np.abs(gram - scale[:, None, None] * np.eye(3)).max(axis=(1, 2)) < 1e-9 * scale
    assert uniform.all() == (linear != "general")
    assert np.allclose(scale, 1) == (linear == "rigid")
    if linear == "scaled":
        assert np.log(scale).std() == pytest.approx(2, rel=0.1)
    np.testing.assert_allclose(found[:, :3, 3].std(axis=0), 1, rtol=0.1)


def test_errors_are_relative_to_what_they_are_of() -> None:
    expected = np.tile(np.eye(4), (3, 1, 1))
    expected[0, :3, :3] *= 10
    expected[1, :3, 3] = 3, 4, 0
    expected[2, :3, :3] = 0
    found = expected.copy()
    found[0, 0, 1] += 0.5
    found[1, 0, 3] -= 1
    linear, translation = benchmark.relative_errors(found, expected)
    assert linear == pytest.approx(0.5 / (10 * np.sqrt(3)))
    assert translation == pytest.approx(1 / 5)
    found[2, 1, 1], found[2, 2, 3] = 0.25, -0.5  # of nothing: as they are
    assert benchmark.relative_errors(found, expected) == (pytest.approx(0.25), pytest.approx(0.5))


def test_times_are_medians_for_each_pose(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = itertools.accumulate(itertools.cycle([1.0, 2.0]))
    monkeypatch.setattr(benchmark.time, "process_time", lambda: next(clock))
    calls: list[str] = []
    rows = benchmark._timed({"a": lambda: calls.append("a"), "b": lambda: calls.append("b")}, 4, 3)
    assert [row["job"] for row in rows] == ["a", "b"]
    assert [row["nanoseconds"] for row in rows] == [pytest.approx(2 / 4 * 1e9)] * 2
    assert calls == ["a", "b"] * 4  # once to warm up


def test_ratios_are_to_the_first_of_their_kind(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("torch")
    monkeypatch.setattr(benchmark, "_timed", lambda jobs, *_: [
        {"job": name, "nanoseconds": float(2 + place)} for place, name in enumerate(jobs)
    ])  # fmt: skip
    monkeypatch.setattr(benchmark, "_clifford_nanoseconds", lambda poses: 60.0)
    speed = benchmark.speed(3, 1, 0)
    assert [row["to_scipy"] for row in speed[:3]] == [1, 1.5, 2]
    assert [row["faster_than_clifford"] for row in speed[:3]] == [30, 20, 15]
    assert speed[-1] == {"job": "clifford, one motor at a time", "nanoseconds": 60.0, "to_scipy": 30.0}
    assert {f"{name} {way}" for name in FORMS for way in ("encode", "decode")} <= {row["job"] for row in speed}
    assert [row["to_svd"] for row in benchmark.stretch_speed(3, 1, 0)] == [1, 1.5, 2, 2.5, 3]
    tensors = benchmark.tensor_speed(3, 1, 0)
    assert [row["to_arrays"] for row in tensors] == pytest.approx([1, 1.5, 2, 1, 6 / 5, 7 / 5, 1, 9 / 8, 10 / 8])


def test_memory_is_counted_in_copies_of_the_input() -> None:
    assert benchmark._peak(lambda: np.zeros(10**6)) == pytest.approx(8e6, rel=0.01)
    rows = benchmark.memory(2000, 0)
    assert [(row["form"], row["poses"]) for row in rows[:2]] == [("matrix", "rigid"), ("matrix", "general")]
    assert all(0.3 < row[way] < 60 for row in rows for way in ("encode", "decode"))


@pytest.mark.slow
def test_everything_agrees_to_machine_precision() -> None:
    pytest.importorskip("clifford")
    for row in benchmark.agreement(0):
        assert row["worst"] < 1e-9, row["check"]
    for row in benchmark.exactness(0):
        assert max(row["linear_float64"], row["translation_float64"]) < 1e-9, row
        assert row["count"] == (1160 if row["poses"] == "rigid" else 23_200)

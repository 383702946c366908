"""Which lines a table of generators has."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("sklearn")

from unisg_blender.experiments.rooms.benchmark_rows import benchmark_rows
from unisg_blender.metrics.layout_features import _middle_object, _Objects


def test_lines_are_of_real_rooms_of_models_of_folders_and_of_baselines(tmp_path: Path) -> None:
    mine, theirs = tmp_path / "mine", tmp_path / "theirs"
    mine.mkdir()
    theirs.mkdir()
    model = tmp_path / "net.onnx"
    plain = [row.name for row in benchmark_rows(model, [theirs, tmp_path / "old.onnx"], False)]
    assert plain == [
        "real rooms", "model, raw", "model, settled", "given rooms, theirs", "old, raw", "old, settled",
    ]  # fmt: skip
    given = benchmark_rows(mine, [theirs, model], True)
    assert [row.name for row in given][:6] == [
        "real rooms", "other real rooms (training)", "given rooms", "given rooms, theirs", "net, raw", "net, settled",
    ]  # fmt: skip
    assert [row.name for row in given][6:] == [
        "category Gaussian, world, raw", "category Gaussian, world, settled", "category Gaussian, on its support, raw",
        "category Gaussian, on its support, settled", "category mean, raw", "nearest training room copied",
        "... with 10 cm jitter",
    ]  # fmt: skip
    assert [row.settle for row in given if row.name.endswith(("raw", "settled"))] == [False, True] * 3 + [False]


def test_the_middle_thing_is_the_largest_near_the_middle_of_the_floor() -> None:
    center = np.array([(0, 0, 0), (4, 4, 0), (1.8, 2, 0), (2.2, 2.1, 0), (2.1, 2, 1), (2.9, 2, 0)], float)
    half = np.array([(2, 2, 1), (2, 2, 1), (0.1, 0.9, 1), (0.5, 0.4, 1), (3, 3, 1), (0.1, 1.9, 1)], float)
    level, none = np.array([0, 0, 0, 0, 1, 0]), np.zeros(6, int)
    rows = _Objects(none, none, none, level, center, half, np.zeros(6), np.zeros((6, 4)))
    assert _middle_object(rows) == 3
    half[2, 0] = 0.3
    assert _middle_object(rows) == 2

"""A damaged file gives a scene or one clear refusal: no traceback, no crash, no hang, and nothing is left behind."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("bpy")

from tests.hostile_files import damaged, is_fault, make_sound_files, outcomes

KINDS = {"usda": 15, "usdc": 6, "usdz": 3, "blend": 8, "glb": 6, "gltf": 8, "json": 10}
"""Files of each kind; benchmarks/hostile_files.py tries thousands."""


@pytest.mark.slow
def test_damaged_files(tmp_path: Path) -> None:
    make_sound_files(tmp_path)
    files = []
    for kind, count in KINDS.items():
        sound = (tmp_path / f"sound.{kind}").read_bytes()
        for number in range(count):
            files.append(tmp_path / f"{number}.{kind}")
            files[-1].write_bytes(damaged(sound, kind, np.random.default_rng([7, number])))
    found = outcomes(files)
    assert not {str(file): outcome for file, outcome in found.items() if is_fault(outcome)}
    assert "scene" in found.values()

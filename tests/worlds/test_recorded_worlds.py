"""The worlds still make what was recorded of them."""

from __future__ import annotations

import json

import numpy as np
import pytest

from unisg_blender.worlds import WORLDS

from .recorded import FILE, SEEDS, summary

AGAIN = "if the change is meant, record it with 'python -m tests.worlds.recorded'"


@pytest.mark.parametrize(("world", "seed"), [(world, seed) for world, seeds in SEEDS.items() for seed in seeds])
def test_a_world_makes_what_was_recorded(world, seed):
    before = json.loads(FILE.read_text(encoding="utf-8"))[world][seed]
    now = summary(WORLDS[world](seed))
    assert now["categories"] == before["categories"], AGAIN
    assert now["said"] == before["said"], AGAIN
    for kind in ("places", "sizes"):
        for category, values in before[kind].items():
            np.testing.assert_allclose(now[kind][category], values, atol=2e-3, err_msg=f"{kind} of {category}; {AGAIN}")

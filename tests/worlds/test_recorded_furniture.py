"""Every piece of furniture still has the corners that were recorded of it."""

from __future__ import annotations

import json

import numpy as np
import pytest

from .recorded_furniture import FILE, pieces, summary

AGAIN = "if the change is meant, record it with 'python -m tests.worlds.recorded_furniture'"
BEFORE = json.loads(FILE.read_text(encoding="utf-8"))
PIECES = pieces()


def test_the_pieces_are_the_recorded_ones() -> None:
    assert sorted(PIECES) == sorted(BEFORE), AGAIN


@pytest.mark.parametrize("name", sorted(BEFORE))
def test_a_piece_is_as_it_was_recorded(name: str) -> None:
    now, before = summary(PIECES[name]), BEFORE[name]
    assert sorted(now) == sorted(before), AGAIN
    for material, values in before.items():
        np.testing.assert_allclose(now[material], values, atol=3e-4, err_msg=f"{material}; {AGAIN}")

"""Hostile inputs of every kind that :mod:`benchmarks.fuzz` makes, a few: none is answered by a traceback or hangs."""

from __future__ import annotations

import pytest

from benchmarks import fuzz

pytestmark = pytest.mark.slow
COUNTS = {"words": 40, "models": 40, "datasets": 120, "properties": 60}


def _forget_settings() -> None:
    """The window manager's settings outlive files and the extension: an export that goes on, as one of them says."""
    import bpy

    for prop in bpy.types.WindowManager.bl_rna.properties:
        if prop.identifier.startswith("unisg"):
            bpy.context.window_manager.property_unset(prop.identifier)


@pytest.mark.parametrize("kind", fuzz.KINDS)
def test_hostile_inputs_are_read_or_refused_in_one_line(
    kind: str, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest
) -> None:
    if kind == "properties":
        pytest.importorskip("bpy")
        request.getfixturevalue("extension")  # which takes it away again
        request.addfinalizer(_forget_settings)
    monkeypatch.setattr(fuzz, "LONGEST", 100.0)  # a machine may be busy; what has no end does not end
    tally = fuzz.run(kind, COUNTS[kind])
    assert not tally.faults, "\n".join(tally.lines())
    assert tally.refused > COUNTS[kind] // 4
    assert tally.read + tally.refused == COUNTS[kind]


def test_the_same_seed_makes_the_same_inputs() -> None:
    first, second = (fuzz.run("datasets", 20, seed=5) for _ in range(2))
    assert (first.read, first.refused) == (second.read, second.refused)


def test_a_fault_is_told_with_its_number(monkeypatch: pytest.MonkeyPatch) -> None:
    def breaks():
        raise KeyError("x")

    monkeypatch.setitem(fuzz.KINDS, "datasets", lambda _: lambda rng: breaks if rng.random() < 0.5 else lambda: None)
    tally = fuzz.run("datasets", 20)
    ((what, numbers),) = tally.faults.items()
    assert what.startswith("KeyError at")
    assert tally.read + len(numbers) == 20
    with pytest.raises(KeyError):
        fuzz.run("datasets", 20, only=numbers[0])

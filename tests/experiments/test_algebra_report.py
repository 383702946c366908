"""The comparison of symmetries, small: all files are written, a second call makes nothing anew, tests are counted."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("torch_geometric")
pytest.importorskip("matplotlib")

from unisg_blender.cli import main
from unisg_blender.experiments.algebra import algebra_report
from unisg_blender.experiments.algebra.algebra_plan import AlgebraPlan, algebra_runs, long_runs
from unisg_blender.experiments.algebra.algebra_tables import LONG, REFERENCE, mean_rows, paired_rows, training_rows
from unisg_blender.learn.symmetry.symmetry_networks import NETWORKS

TINY = AlgebraPlan(("supports", "foreign kinds"), (4,), 1, parameters=4000, steps=25, seconds=0.0, tests=2)


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open() as file:
        return list(csv.DictReader(file))


@pytest.mark.slow
def test_everything_is_written_and_a_second_call_goes_on(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(algebra_report, "QUICK_PLAN", TINY)
    out = tmp_path / "out"
    words = ["benchmark", "algebra", "--quick", "--jobs", "1", "--out", str(out), "-q"]
    assert main([*words, "--tables-only"]) == 1
    assert "no finished training" in capsys.readouterr().err
    assert main([*words, "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["trainings"] == {"planned": len(NETWORKS), "done": len(NETWORKS)}  # none on rooms that are not given
    assert report["data"]["own-test"]["rooms"] == 2
    single = rows_of(out / "algebra_runs.csv")
    assert {row["tested"] for row in single} == {"own", "own, turned"}
    assert {row["network"] for row in single} == set(NETWORKS)
    assert all(0 <= float(row["error"]) <= 1 and int(row["step"]) == 25 for row in single)
    assert {"algebra.png", "algebra.svg", "algebra_means.csv", "algebra_tests.csv"} <= {p.name for p in out.iterdir()}
    monkeypatch.setattr("unisg_blender.experiments.paper.runs._do", None)  # nothing is trained again
    assert main(words) == 0
    assert rows_of(out / "algebra_runs.csv") == single
    assert main(["benchmark", "algebra", "--jobs", "1", "--out", str(out), "-q"]) == 1
    assert "made with --quick" in capsys.readouterr().err


def test_houses_that_are_not_there_are_asked_for(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = [
        "benchmark",
        "algebra",
        "--quick",
        "--jobs",
        "1",
        "--out",
        str(tmp_path / "out"),
        "--data",
        str(tmp_path),
        "-q",
    ]
    assert main(words) == 1
    assert "oneroom.jsonl.gz" in capsys.readouterr().err


def test_the_plan_is_balanced_and_has_each_training_once() -> None:
    runs = algebra_runs(AlgebraPlan(), foreign=True)
    assert len({run.key for run in runs}) == len(runs) == 10 * len(NETWORKS) * (5 * 5 + 3)
    assert [run.settings["seed"] for run in runs] == sorted(run.settings["seed"] for run in runs)
    longer = long_runs(AlgebraPlan())
    assert not {run.key for run in longer} & {run.key for run in runs}
    assert {run.settings["steps"] for run in longer} == {5 * AlgebraPlan().steps}
    assert not long_runs(AlgebraPlan(rooms=(10,)))
    assert not any(run.settings["task"] == "foreign kinds" for run in algebra_runs(AlgebraPlan(), foreign=False))


def made_up(better: float) -> list[dict[str, Any]]:
    """A network that is better than the reference, the more so the larger the seed, and one that is like it."""
    keys = {"task": "supports", "tested": "own", "budget": "equal steps", "parameters": 1, "step": 1, "seconds": 1.0}
    return [
        keys | {"rooms": rooms, "seed": seed, "network": name, "error": 0.3 + 0.01 * seed - gain * (1 + seed)}
        for rooms in (10, 30, 100, 1000)
        for seed in range(4)
        for name, gain in ((REFERENCE, 0.0), ("PGA", better), ("EGNN", 0.0))
    ]


def test_differences_are_tested_over_seeds_and_few_rooms() -> None:
    table = {row["network"]: row for row in paired_rows(made_up(0.02))}
    assert table["PGA"]["pairs"] == 12  # not those with 1,000 rooms
    assert table["PGA"]["difference"] == pytest.approx(-0.05)
    assert table["PGA"]["better"] == 12
    assert table["PGA"]["p_holm"] < 0.01
    assert table["EGNN"]["p"] is None  # nothing differs


def test_longer_trainings_stand_apart() -> None:
    runs = [*algebra_runs(AlgebraPlan(("supports",), (30,), 1), False), *long_runs(AlgebraPlan(seeds=1))]
    result = {
        "parameters": 5,
        "steps": {"step": 25, "seconds": 1.0, "own": 0.2},
        "time": {"step": 50, "seconds": 3.0, "own": 0.1},
    }
    rows = training_rows(runs, {run.key: {"result": result} for run in runs})
    assert {(row["budget"], row["error"]) for row in rows} == {("equal steps", 0.2), ("equal time", 0.1), (LONG, 0.2)}
    assert LONG not in {row["budget"] for row in paired_rows(rows)}


def test_means_have_intervals() -> None:
    row = next(row for row in mean_rows(made_up(0.0)) if row["network"] == REFERENCE)
    assert row["seeds"] == 4
    assert row["error"] == pytest.approx(0.315)
    assert 0.01 < row["error_ci"] < 0.03

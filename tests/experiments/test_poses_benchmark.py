"""``unisg benchmark poses``: its files, and the promised exactness."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from unisg_blender.cli import main
from unisg_blender.poses import FORMS
from unisg_blender.runtime.made_files import MARKER

pytest.importorskip("matplotlib")
pytest.importorskip("threadpoolctl")
pytest.importorskip("clifford")


@pytest.mark.slow
def test_writes_tables_and_figures(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "made" / "here"
    assert main(["benchmark", "poses", "--out", str(out), "--count", "2000", "--repeats", "1", "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert json.loads((out / "poses.json").read_text()) == report
    for table, rows in report["tables"].items():
        with (out / f"poses_{table}.csv").open(newline="") as file:
            assert len(list(csv.DictReader(file))) == len(rows) > 0
    assert (out / "poses.png").read_bytes().startswith(b"\x89PNG")
    assert (out / "poses.svg").read_text().lstrip().startswith("<?xml")
    assert [path.name for path in out.iterdir() if path.name.startswith(".")] == [MARKER]
    exact = report["tables"]["exactness"]
    assert {row["form"] for row in exact} == set(FORMS)
    for row in exact:
        assert max(row["linear_float64"], row["translation_float64"]) < 1e-12
        assert max(row["linear_float32"], row["translation_float32"]) < 1e-6
    assert max(row["worst"] for row in report["tables"]["agreement"]) < 1e-12


def test_misuse_is_told(tmp_path: Path) -> None:
    assert main(["benchmark", "nothing", "--out", str(tmp_path)]) == 2
    assert main(["benchmark", "poses", "--out", str(tmp_path), "--count", "0"]) == 1
    assert not list(tmp_path.iterdir())

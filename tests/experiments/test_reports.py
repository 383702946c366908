"""What a file of results says of itself."""

from __future__ import annotations

import json
import sys
from datetime import date
from pathlib import Path

import pytest

from unisg_blender.experiments.reports import made_by, write_results


@pytest.mark.parametrize(
    ("arguments", "command"),
    [
        (["/somewhere/benchmarks/usd.py", "--runs", "1"], "python benchmarks/usd.py --runs 1"),
        (["/somewhere/unisg_blender/__main__.py", "benchmark", "poses"], "unisg benchmark poses"),
        (["/bin/unisg", "evaluate", "/home/someone/my rooms"], "unisg evaluate 'my rooms'"),
    ],
)
def test_results_name_their_command_without_the_machines_paths(
    monkeypatch: pytest.MonkeyPatch, arguments: list[str], command: str
) -> None:
    monkeypatch.setattr(sys, "argv", arguments)
    assert made_by()["command"] == command


def test_a_script_is_told_from_the_projects_root_on(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "pyproject.toml").write_text("", "utf-8")
    (tmp_path / "benchmarks" / "interiors").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "benchmarks" / "interiors")
    monkeypatch.setattr(sys, "argv", ["measure.py", "--all"])
    assert made_by()["command"] == "python benchmarks/interiors/measure.py --all"


def test_results_are_written_with_command_date_and_machine(tmp_path: Path) -> None:
    write_results(tmp_path / "new" / "found.json", {"rows": [1]})
    record = json.loads((tmp_path / "new" / "found.json").read_text("utf-8"))
    assert list(record) == ["command", "date", "machine", "rows"]
    assert record["date"] == date.today().isoformat()

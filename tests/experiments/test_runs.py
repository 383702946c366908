"""Trainings are kept one by one: a stopped batch goes on, nothing is made twice, what is damaged is told."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from unisg_blender.errors import UniSGError
from unisg_blender.experiments.paper import runs
from unisg_blender.experiments.paper.runs import Run, finished, run_all

CALLS: list[int] = []


def work(settings: dict[str, Any], data: Path) -> dict[str, Any]:
    CALLS.append(settings["seed"])
    if settings["seed"] == settings.get("fails"):
        raise KeyboardInterrupt
    return {"twice": 2 * settings["seed"]}


@pytest.fixture(autouse=True)
def known(monkeypatch: pytest.MonkeyPatch) -> None:
    class Here:
        work = staticmethod(work)

    CALLS.clear()
    monkeypatch.setitem(runs.EXPERIMENTS, "toy", (1, "here:work"))
    monkeypatch.setattr(runs.importlib, "import_module", lambda name, package=None: Here)


def toys(count: int, **more: Any) -> list[Run]:
    return [Run("toy", {"seed": seed, **more}) for seed in range(count)]


def test_each_is_done_once(tmp_path: Path) -> None:
    found = run_all([*toys(3), *toys(2)], tmp_path, 1, quiet=True)
    assert [found[run.key]["result"]["twice"] for run in toys(3)] == [0, 2, 4]
    assert CALLS == [0, 1, 2]
    run_all(toys(4), tmp_path, 1, quiet=True)
    assert CALLS == [0, 1, 2, 3]
    assert not list((tmp_path / "runs").glob(".*"))


def test_a_stopped_batch_goes_on(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt):
        run_all(toys(4, fails=2), tmp_path, 1, quiet=True)
    assert len(finished(toys(4, fails=2), tmp_path)) == 2
    assert len(list((tmp_path / "runs").iterdir())) == 2


def test_other_settings_or_code_are_another_training(monkeypatch: pytest.MonkeyPatch) -> None:
    one = Run("toy", {"seed": 0, "epochs": 3})
    assert one.key == Run("toy", {"epochs": 3, "seed": 0}).key
    assert one.key != Run("toy", {"seed": 1, "epochs": 3}).key
    before = one.key
    monkeypatch.setitem(runs.EXPERIMENTS, "toy", (2, "here:work"))
    assert one.key != before


def test_a_damaged_result_is_named(tmp_path: Path) -> None:
    run_all(toys(1), tmp_path, 1, quiet=True)
    path = tmp_path / "runs" / f"{toys(1)[0].key}.json"
    path.write_text(json.dumps(json.loads(path.read_text()))[:-5])
    with pytest.raises(UniSGError, match="remove it"):
        run_all(toys(1), tmp_path, 1, quiet=True)

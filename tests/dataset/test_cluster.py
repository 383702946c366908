"""``--scheduler``: a Dask scheduler and a worker as processes of their own."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

from tests.dask_cluster import cluster
from unisg_blender.cli import main
from unisg_blender.dataset.export.batch_export import ExportOptions, export_dataset

pytestmark = pytest.mark.slow

pytest.importorskip("distributed")
HERE = Path(__file__).parent
READER = "fake_reader:read"


def test_a_cluster_gives_the_same_dataset(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", str(HERE), prepend=os.pathsep)
    defaults = ExportOptions.__init__.__defaults__
    assert defaults is not None
    monkeypatch.setattr(ExportOptions.__init__, "__defaults__", (*defaults[:-1], READER))
    (tmp_path / "in").mkdir()
    for number in range(6):
        trouble = "crash" if number == 3 else ""
        (tmp_path / "in" / f"{number}.obj").write_text(json.dumps({"seed": number, "trouble": trouble}))
    with cluster(1, 2, PYTHONPATH=str(HERE)) as (address, _):
        words = ["export", str(tmp_path / "in"), "--out", str(tmp_path / "ds"), "--scheduler", address, "-q"]
        assert main(words) == 3  # one of them crashes its reader, and only that
    export_dataset([tmp_path / "in"], tmp_path / "own", ExportOptions(timeout=300.0), jobs=2)
    named = [{path.name: path.read_bytes() for path in (tmp_path / name).iterdir()} for name in ("ds", "own")]
    assert named[0] == named[1]

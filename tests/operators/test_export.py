"""The operator "Export Dataset" in a Blender process of its own."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from unisg_blender.dataset import open_dataset


@pytest.mark.slow
@pytest.mark.skipif(find_spec("bpy") is None, reason="needs Blender")
def test_operator_writes_the_open_scenes(tmp_path: Path) -> None:
    script = Path(__file__).with_name("export_script.py")
    run = subprocess.run([sys.executable, str(script), str(tmp_path)], capture_output=True, text=True, timeout=120)
    assert "RESULT" in run.stdout, run.stderr
    seen = json.loads(run.stdout.split("RESULT", 1)[1].splitlines()[0])
    assert seen["new"] == seen["all"] == ["FINISHED"]
    assert "holds a dataset already" in seen["again"]
    assert "choose a folder" in seen["nowhere"]
    assert "save this file first" in seen["unsaved"]
    assert seen["untouched"]
    assert seen["default"] == "quaternion"
    assert seen["files"] == seen["resumed"] == ["FINISHED"]
    batch = open_dataset(tmp_path / "batch")
    assert [scene.title for scene in batch] == ["Scene", "Second"]
    assert [record["status"] for record in batch.files()] == ["ok"]
    dataset = open_dataset(tmp_path / "ds")
    assert [scene.title for scene in dataset] == ["Scene", "Second"]
    assert dataset.form == "quaternion"
    assert dict(zip(dataset[0].strings("entity.name"), dataset[0].categories, strict=True))["Cube"] == "Box"

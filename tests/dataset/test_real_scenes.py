"""Scenes that others made, exported through Blender and compared with what Blender says of them."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from unisg_blender.dataset import open_dataset, to_scenegraph
from unisg_blender.dataset.export.batch_export import ExportOptions, export_dataset
from unisg_blender.dataset.export.sources import find_sources
from unisg_blender.runtime.file_endings import USD, is_of
from unisg_blender.scene import world_matrices

pytestmark = [pytest.mark.slow, pytest.mark.skipif(find_spec("bpy") is None, reason="needs Blender")]

HERE = Path(__file__).parent
FOLDERS = [HERE.parent / "data", *map(Path, filter(None, [os.environ.get("UNISG_SCENES")]))]


def test_hierarchy_and_world_matrices_are_kept(tmp_path: Path) -> None:
    options = ExportOptions(instances="keep")  # copies would have the names of what they are copies of
    records = export_dataset(FOLDERS, tmp_path / "ds", options, jobs=2)
    assert [record["source"] for record in records if record["status"] != "ok"] == []
    paths = [record["source"] for record in records if record["scenes"] and not is_of(Path(record["source"]), USD)]
    command = [sys.executable, str(HERE / "blender_worlds.py"), *paths]
    run = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, timeout=250, check=True)
    truth = json.loads(run.stdout)
    checked = 0
    for scene in open_dataset(tmp_path / "ds"):
        if scene.source not in truth:  # Blender's importer of USD makes other objects; USD itself is asked in tests/usd
            continue
        graph = to_scenegraph(scene)
        expected = truth[scene.source][scene.title]
        assert set(graph.name) >= set(expected)
        for name, world in zip(graph.name, world_matrices(graph), strict=True):
            if name not in expected:
                continue
            scale = np.abs(expected[name]).max()
            assert_allclose(world, expected[name], atol=1e-5 * scale, err_msg=f"{scene.source}: {name}")
            checked += 1
    assert checked > 20


def test_a_corrupt_file_does_not_stop_the_batch(tmp_path: Path) -> None:
    good = next(path for path in find_sources(FOLDERS[:1]) if path.suffix == ".glb")
    for name, data in (("cut.glb", good.read_bytes()[:999]), ("text.blend", b"hello"), ("good.glb", good.read_bytes())):
        (tmp_path / "in" / name).parent.mkdir(exist_ok=True)
        (tmp_path / "in" / name).write_bytes(data)
    records = export_dataset([tmp_path / "in"], tmp_path / "ds", jobs=1)
    assert [record["status"] for record in records] == ["failed", "ok", "failed"]
    assert len(open_dataset(tmp_path / "ds")) == 1

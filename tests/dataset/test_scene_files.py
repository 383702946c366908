"""Files as studios have them, read by Blender: linked libraries, instances, buffers and layers beside them."""

from __future__ import annotations

import subprocess
import sys
from collections import Counter
from importlib.util import find_spec
from pathlib import Path

import pytest

from unisg_blender.dataset import open_dataset
from unisg_blender.dataset.export.batch_export import ExportOptions, export_dataset

pytestmark = [pytest.mark.slow, pytest.mark.skipif(find_spec("bpy") is None, reason="needs Blender")]
MAPPING = {"objects": {"chair*": "Chair"}}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("files")
    for name in ("in", "lib"):
        (folder / name).mkdir()
    script = Path(__file__).with_name("make_files.py")
    subprocess.run([sys.executable, str(script), str(folder)], capture_output=True, timeout=120, check=True)
    return folder


def test_instances_and_files_beside(folder: Path, tmp_path: Path) -> None:
    sources = [folder / "in" / name for name in ("a.blend", "b two.gltf", "c.obj", "d.usda")]
    options = ExportOptions(mapping=MAPPING, timeout=120)
    records = export_dataset(sources, tmp_path / "ds", options, jobs=2)
    assert [record["status"] for record in records] == ["ok"] * 4, records
    assert [sorted(record["beside"]) for record in records] == [
        ["../lib/chairs.blend"],
        ["b two.bin"],
        ["c.mtl"],
        ["parts/deep.usdc", "parts/inner.usda"],
    ]
    dataset = open_dataset(tmp_path / "ds")
    assert Counter(filter(None, dataset[0].categories)) == {"Chair": 2, "Book": 9, "Shelf": 1}
    shapes = dataset.assets()
    assert shapes is not None
    assert {record["category"] for record in shapes.index["assets"]} == {"Chair", "Book", "Shelf"}
    (folder / "in" / "c.mtl").write_text("newmtl Wood\nKd 1 0 0\n")
    again = export_dataset(sources, tmp_path / "ds", options, jobs=1, resume=True)
    assert again[2]["beside"] != records[2]["beside"]
    assert [one == two for one, two in zip(again, records, strict=True)] == [True, True, False, True]


def test_instances_can_be_left_out(folder: Path, tmp_path: Path) -> None:
    options = ExportOptions(mapping=MAPPING, instances="keep", timeout=120)
    records = export_dataset([folder / "in" / "a.blend"], tmp_path / "ds", options, jobs=1)
    assert "instances" in records[0]["not_represented"]
    counts = Counter(filter(None, open_dataset(tmp_path / "ds")[0].categories))
    assert (counts["Book"], counts["Shelf"], len(open_dataset(tmp_path / "ds")[0])) == (1, 1, 4)

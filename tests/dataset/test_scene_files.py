"""Files as studios have them, read by Blender: linked libraries, instances, buffers and layers beside them."""

from __future__ import annotations

import math
import subprocess
import sys
from collections import Counter
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from unisg_blender.dataset import open_dataset, to_scenegraph
from unisg_blender.dataset.export.batch_export import ExportOptions, export_dataset
from unisg_blender.scene import world_matrices

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


BRICKS = """#usda 1.0
(defaultPrim = "World"; metersPerUnit = 1; upAxis = "Z")
def Xform "World" {
    def PointInstancer "Bricks" {
        point3f[] positions = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        int[] protoIndices = [0, 0, 0]
        quatf[] orientationsf = [(1, 0, 0, 0), (0.70710678, 0, 0, 0.70710678), (0.9238795, 0, 0.38268343, 0)]
        rel prototypes = </World/Bricks/Brick>
        def Mesh "Brick" {
            point3f[] points = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0)]
            int[] faceVertexCounts = [4]
            int[] faceVertexIndices = [0, 1, 2, 3]
        }
    }
}
"""

ROWS = """#usda 1.0
(defaultPrim = "World"; metersPerUnit = 1; upAxis = "Z")
class Xform "Asset" {
    def PointInstancer "Rows" {
        point3f[] positions = [(0, 0, 0), (2, 0, 0)]
        int[] protoIndices = [0, 0]
        rel prototypes = </Asset/Rows/Box>
        double3 xformOp:translate = (0, 5, 0)
        uniform token[] xformOpOrder = ["xformOp:translate"]
        def Cube "Box" {
            double size = 1
        }
    }
}
def Xform "World" {
    def Xform "A" (references = </Asset>; instanceable = true) {
        double3 xformOp:translate = (0, 0, 1)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
    def Xform "B" (references = </Asset>; instanceable = true) {
        double3 xformOp:translate = (20, 0, 1)
        double xformOp:rotateZ = 90
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateZ"]
    }
}
"""


def test_a_master_file_is_read_as_all_verbs_read_it(tmp_path: Path) -> None:
    """The same room as .blend, .usda and .json gives the same entities and relations; instancers give their copies."""
    from unisg_blender.formats.scene_files import load_blender, write_scene_file
    from unisg_blender.worlds import operating_room

    load_blender()
    room = operating_room(3)
    sources = [tmp_path / f"room.{ending}" for ending in ("blend", "json", "usda")]
    for path in sources:
        write_scene_file(room, path)
    (tmp_path / "bricks.usda").write_text(BRICKS)
    (tmp_path / "rows.usda").write_text(ROWS)
    sources = [tmp_path / "bricks.usda", *sources, tmp_path / "rows.usda"]
    records = export_dataset(sources, tmp_path / "ds", ExportOptions(timeout=120), jobs=1)
    assert [record["status"] for record in records] == ["ok"] * 5, records
    bricks, *rooms, rows = map(to_scenegraph, open_dataset(tmp_path / "ds"))
    kinds = Counter(room.components["relations"].columns["kind"].tolist())
    for found in rooms:
        assert Counter(found.category_name(row) for row in range(len(found))) == Counter(
            room.category_name(row) for row in range(len(room))
        )
        assert Counter(found.components["relations"].columns["kind"].tolist()) == kinds
    turns = world_matrices(bricks)[bricks.mesh >= 0]
    angles = sorted(round(math.degrees(math.acos((np.trace(turn[:3, :3]) - 1) / 2))) for turn in turns)
    assert angles == [0, 45, 90]
    places = sorted(tuple(np.round(world[:3, 3], 6)) for world in world_matrices(rows)[rows.mesh >= 0])
    assert places == [(0, 5, 1), (2, 5, 1), (15, 0, 1), (15, 2, 1)]

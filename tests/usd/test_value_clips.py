"""Motion that a stage takes from value clips in other files."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from unisg_blender.usd import read_usd

CLIP = """#usda 1.0
def "Model"
{
    double3 xformOp:translate.timeSamples = { 1: (0, 0, 0), 10: (9, 0, 0) }
}
"""
STAGE = """#usda 1.0
(
    startTimeCode = 1
    endTimeCode = 10
    upAxis = "Z"
    metersPerUnit = 1
)
def Cube "Model" (
    clips = {
        dictionary default = {
            asset[] assetPaths = [@./clip.usda@]
            string primPath = "/Model"
            double2[] active = [(1, 0)]
            double2[] times = [(1, 1), (10, 10)]
            asset manifestAssetPath = @./clip.usda@
        }
    }
)
{
    double3 xformOp:translate
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
"""


def test_motion_in_value_clips_is_read(tmp_path: Path) -> None:
    (tmp_path / "clip.usda").write_text(CLIP)
    (tmp_path / "stage.usda").write_text(STAGE)
    graph = read_usd(tmp_path / "stage.usda")
    ((row, matrices),) = graph.entries("animation", "matrices")
    assert graph.name[row] == "Model"
    np.testing.assert_allclose(matrices[[0, -1], 0, 3], [0, 9])

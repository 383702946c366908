"""Frames and rates of stages of other tools."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest

from unisg_blender.scene import FrameRange, SceneGraph
from unisg_blender.usd import read_usd

SAMPLES = "double3 xformOp:translate.timeSamples = { 0: (0, 0, 0), 48: (48, 0, 0) }"
STILL = "double3 xformOp:translate = (0, 0, 0)"


def stage(folder: Path, metadata: str, motion: str = SAMPLES) -> SceneGraph:
    """What is read of a stage with one thing in it."""
    path = folder / "stage.usda"
    path.write_text(f"""#usda 1.0
(
    upAxis = "Z"
    metersPerUnit = 1
    {metadata}
)
def Xform "Cart"
{{
    {motion}
    uniform token[] xformOpOrder = ["xformOp:translate"]
}}
""")
    return read_usd(path)


@pytest.mark.parametrize(
    ("metadata", "frames", "seconds"),
    [
        ("startTimeCode = 10\nendTimeCode = 20", FrameRange(10, 10, 20, 24), 2),
        ("timeCodesPerSecond = 48", FrameRange(0, 0, 48, 48), 1),
        (
            "timeCodesPerSecond = 48\nframesPerSecond = 24\nstartTimeCode = 4\nendTimeCode = 8",
            FrameRange(2, 2, 4, 24),
            1,
        ),
        ("timeCodesPerSecond = 1\nframesPerSecond = 30", FrameRange(0, 0, 1440, 30), 48),
        ("framesPerSecond = 30", FrameRange(0, 0, 48, 30), 1.6),
    ],
)
def test_the_frames_of_a_stage(tmp_path: Path, metadata: str, frames: FrameRange, seconds: float) -> None:
    graph = stage(tmp_path, metadata)
    assert graph.frames == frames
    ((_, times, matrices),) = graph.entries("animation", "times", "matrices")
    np.testing.assert_allclose(times, [0, seconds])
    np.testing.assert_allclose(matrices[:, 0, 3], [0, 48])


def test_a_still_stage_has_the_frames_that_it_names(tmp_path: Path) -> None:
    assert stage(tmp_path, "", STILL).frames is None
    assert stage(tmp_path, "startTimeCode = 1\nendTimeCode = 2", STILL).frames == FrameRange(1, 1, 2, 24)


BOX = """#usda 1.0
(
    defaultPrim = "Box"
)
def Xform "Box"
{
    double3 xformOp:translate.timeSamples = { 0: (0, 0, 0), 24: (100, 0, 0) }
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
"""
NO_RATES = ("0", "-24", "nan", "inf", "1e308", "1e-308")


def told_of(path: Path) -> tuple[SceneGraph, list[str]]:
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        return read_usd(path), [str(each.message) for each in told]


@pytest.mark.parametrize("below", ["subLayers = [@box.usda@]", ""])
@pytest.mark.parametrize("rate", NO_RATES)
def test_a_rate_that_cannot_be_is_told_and_read_as_the_usual_one(tmp_path: Path, rate: str, below: str) -> None:
    (tmp_path / "box.usda").write_text(BOX if below else BOX.replace("(\n", f"(\n    timeCodesPerSecond = {rate}\n", 1))
    (tmp_path / "stage.usda").write_text(f"#usda 1.0\n(\n    timeCodesPerSecond = {rate}\n    {below}\n)\n")
    reference = 'def "Copy" (references = @box.usda@)\n{\n}\n'
    if not below:
        (tmp_path / "stage.usda").write_text(f"#usda 1.0\n{reference}")
    graph, told = told_of(tmp_path / "stage.usda")
    ((_, times, _),) = graph.entries("animation", "times", "matrices")
    np.testing.assert_allclose(times, [0, 1])
    assert [line for line in told if line.endswith("time codes per second are no rate; read as 24")]


@pytest.mark.parametrize("offset", [f"{key} = {value}" for key in ("offset", "scale") for value in NO_RATES])
def test_samples_that_an_offset_puts_beyond_all_time_are_left_out(tmp_path: Path, offset: str) -> None:
    (tmp_path / "box.usda").write_text(BOX)
    (tmp_path / "stage.usda").write_text(f'#usda 1.0\ndef "Copy" (references = @box.usda@ ({offset}))\n{{\n}}\n')
    graph, told = told_of(tmp_path / "stage.usda")
    for _, times, matrices in graph.entries("animation", "times", "matrices"):
        assert np.isfinite(times).all()
        assert (np.diff(times) > 0).all()
        assert np.isfinite(matrices).all()
    complete = [len(times) for _, times in graph.entries("animation", "times")] == [2]
    assert complete or any("samples that are no moments" in line for line in told)


@pytest.mark.parametrize("unit", ["0", "-1", "nan", "inf", "1e308"])
def test_a_unit_that_cannot_be_is_told_and_read_as_metres(tmp_path: Path, unit: str) -> None:
    (tmp_path / "stage.usda").write_text(BOX.replace('"Box"', f'"Box"\n    metersPerUnit = {unit}', 1))
    graph, told = told_of(tmp_path / "stage.usda")
    ((_, matrices),) = graph.entries("animation", "matrices")
    assert matrices[-1].max() == pytest.approx(100)
    assert [line for line in told if line.endswith("metres cannot be; read as 1 metre")]


@pytest.mark.parametrize("ends", [("5", "1"), ("nan", "1"), ("0", "inf"), ("-1e308", "1e308")])
def test_a_range_that_cannot_be_is_told_and_left_out(tmp_path: Path, ends: tuple[str, str]) -> None:
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        graph = stage(tmp_path, f"startTimeCode = {ends[0]}\nendTimeCode = {ends[1]}")
    assert graph.frames is None
    assert len(graph.components["animation"].rows) == 1
    assert [str(each.message) for each in told if "the frames of the stage are not read" in str(each.message)]

"""Frame, range and rate of a scene, and keys beyond the range, on the way through every kind of file."""

from __future__ import annotations

import math
import struct
from pathlib import Path

import bpy
import numpy as np
import pytest

from tests.blender.helpers import add, box
from unisg_blender.blender import ReadReport, read_scene, save_blend, write_scene
from unisg_blender.blender.fcurves import curves_of
from unisg_blender.formats import read_scene_file, write_scene_file
from unisg_blender.scene import FrameRange, SceneBuilder, SceneGraph, table


def cart(*keys: tuple[float, float]) -> bpy.types.Object:
    """An object that goes from place to place along X: keys (frame, x), straight between them."""
    item = add("cart", box())
    for frame, x in keys:
        item.location = (x, 0, 0)
        item.keyframe_insert("location", frame=frame)
    for curve in curves_of(item):
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    return item


def play(start: int, end: int, frame: int, fps: int = 24, base: float = 1.0) -> None:
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end, scene.render.fps, scene.render.fps_base = start, end, fps, base
    scene.frame_set(frame)


def motion(graph: SceneGraph) -> tuple[np.ndarray, np.ndarray]:
    """Seconds and x of what moves."""
    ((_, times, matrices),) = graph.entries("animation", "times", "matrices")
    return times, matrices[:, 0, 3]


def assert_moves_like(graph: SceneGraph, keys: list[tuple[float, float]]) -> None:
    """At every sample it is where the straight lines between keys (seconds, x) put it, from the first to the last."""
    times, x = motion(graph)
    moments, places = np.array(keys).T
    np.testing.assert_allclose([times[0], times[-1]], moments[[0, -1]], atol=1e-4)
    np.testing.assert_allclose(x, np.interp(times, moments, places), atol=1e-3)


@pytest.mark.parametrize("ending", [".blend", ".usda", ".usdc", ".json"])
@pytest.mark.parametrize("rate", [(30, 1.0), (30, 1.001), (25, 2.0)])
def test_frame_range_and_rate_come_back(tmp_path: Path, ending: str, rate: tuple[int, float]) -> None:
    cart((1001, 0), (1061, 4.5))
    play(1001, 1061, 1031, *rate)
    save_blend(tmp_path / "first.blend")
    per_second = rate[0] / bpy.context.scene.render.fps_base
    graph, _ = read_scene_file(tmp_path / "first.blend", animation=True)
    assert graph.frames == FrameRange(1031, 1001, 1061, per_second)
    write_scene_file(graph, tmp_path / f"second{ending}")
    again, _ = read_scene_file(tmp_path / f"second{ending}", animation=True)
    write_scene_file(again, tmp_path / "third.blend")
    last, lost = read_scene_file(tmp_path / "third.blend", animation=True)
    assert last.frames.rate == pytest.approx(per_second, rel=1e-7)
    assert (last.frames.frame, last.frames.start, last.frames.end) == (1031, 1001, 1061)
    assert not [line for line in lost if "Frame" in line or "frame" in line]
    assert_moves_like(last, [(1001 / per_second, 0), (1061 / per_second, 4.5)])
    scene = bpy.context.scene
    assert (scene.frame_current, scene.frame_start, scene.frame_end) == (1031, 1001, 1061)


@pytest.mark.parametrize("ending", ["glb", "fbx"])
def test_all_keys_of_an_imported_file_are_read(tmp_path: Path, ending: str) -> None:
    cart((0, 0), (600, 60))
    bpy.context.scene.frame_end = 600
    for addon in ("io_scene_gltf2", "io_scene_fbx"):
        bpy.ops.preferences.addon_enable(module=addon)
    path = tmp_path / f"long.{ending}"
    if ending == "glb":
        bpy.ops.export_scene.gltf(filepath=str(path))
    else:
        bpy.ops.export_scene.fbx(filepath=str(path), bake_anim=True)
    graph, _ = read_scene_file(path, animation=True)
    start = {"glb": 0, "fbx": 1}[ending]  # where the importers put the first key
    assert (graph.frames.start, graph.frames.end) == (start, start + 600)
    assert_moves_like(graph, [(start / 24, 0), (start / 24 + 25, 60)])


def test_keys_beyond_the_range_and_between_frames_are_read() -> None:
    cart((-10, 0), (3.5, 1), (4, 7), (300.25, 9))
    graph = read_scene(animation=True)
    assert (graph.frames.start, graph.frames.end) == (1, 250)
    assert_moves_like(graph, [(-10 / 24, 0), (3.5 / 24, 1), (4 / 24, 7), (300.25 / 24, 9), (301 / 24, 9)])
    assert 3.5 / 24 in motion(graph)[0]


def test_a_motion_without_end_is_read_here_and_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("unisg_blender.blender.read.sampled_animation.MOST_FRAMES", 100)
    cart((1, 0), (7, 5), (1_000_000, 1))
    play(1, 3, 1)
    report = ReadReport()
    graph = read_scene(animation=True, report=report)
    assert 100 <= len(motion(graph)[0]) <= 103
    assert_moves_like(graph, [(1 / 24, 0), (7 / 24, 5), (1_000_000 / 24, 1)])
    assert "all frames of its motion: of 1,000,000 one in 10,000 is read, beside the keys" in list(report)


@pytest.mark.parametrize(
    ("name", "kept", "damaged", "told"),
    [
        ("fps_base", struct.pack("<f", 1.2345678), struct.pack("<f", 0.0), "its frame rate cannot be played"),
        ("fps_base", struct.pack("<f", 1.2345678), struct.pack("<f", math.nan), "its frame rate cannot be played"),
        ("frame_end", struct.pack("<i", 987654), struct.pack("<i", 2**31 - 1), "the frames 7 to 2147483647 cannot be"),
        ("frame_end", struct.pack("<i", 987654), struct.pack("<i", -(2**31)), "the frames 7 to -2147483648 cannot be"),
        ("scale_length", struct.pack("<f", 0.7654321), struct.pack("<f", 0.0), "the unit scale 0 is not applied"),
    ],
)
def test_frames_and_units_of_a_damaged_file(tmp_path: Path, name: str, kept: bytes, damaged: bytes, told: str) -> None:
    cart((7, 0), (9, 1))
    scene = bpy.context.scene
    scene.frame_end, scene.frame_start = 987654 if name == "frame_end" else 9, 7
    scene.render.fps_base = 1.2345678 if name == "fps_base" else 1.0
    scene.unit_settings.scale_length = 0.7654321
    path = tmp_path / "damaged.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, compress=False)
    assert kept in path.read_bytes()
    path.write_bytes(path.read_bytes().replace(kept, damaged))
    graph, lost = read_scene_file(path)
    assert [line for line in lost if line.startswith(told)]
    assert graph.frames.start == 7
    assert graph.frames.end in (7, 9, 1048574)
    assert graph.frames.rate == 24


def one_box(frames: FrameRange | None) -> SceneGraph:
    builder = SceneBuilder()
    builder.add("cart", uid="cart")
    moving = table([0], times=[np.array([0.0, 20.0])], matrices=[np.array([np.eye(4), np.eye(4)])])
    return builder.build().replace(components={"animation": moving}, frames=frames)


@pytest.mark.parametrize(
    ("frames", "held", "told"),
    [
        (None, (0, 480, 24.0), ""),
        (FrameRange(5, 1, 9, 24), (1, 9, 24.0), ""),
        (FrameRange(-3, -7.5, 9.5, 24), (0, 10, 24.0), "the frames -7.5 to 9.5 become 0 to 10"),
        (FrameRange(1, 1, 9, 99_999), (1, 9, 99_999.0), ""),
        (FrameRange(1, 1, 9, 0.001), (1, 9, 0.001), ""),
    ],
)
def test_what_blender_cannot_hold_of_frames_is_told(frames: FrameRange | None, held: tuple, told: str) -> None:
    report = ReadReport()
    scene = write_scene(one_box(frames), report=report)
    assert (scene.frame_start, scene.frame_end) == held[:2]
    assert scene.render.fps / scene.render.fps_base == pytest.approx(held[2], rel=1e-6)
    assert [line for line in report if "frames" in line] == ([told] if told else [])

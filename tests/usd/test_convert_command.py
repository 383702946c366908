"""``unisg convert``: every way between the kinds of files, and inputs that cannot be used."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.usd.compare import assert_same_graph
from tests.usd.test_edits import studio
from unisg_blender.cli import main
from unisg_blender.usd import read_usd, write_usd

DATA = Path(__file__).parents[1] / "data"
NESTED = DATA / "usd-wg-assets/test_assets/schemaTests/usdGeom/transforms/xforms_nested.usda"


def test_from_usd_to_usd_and_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_usd(studio(), tmp_path / "in.usda")
    for target in ("out.usdc", "out.usdz", "out.usd"):
        assert main(["convert", str(tmp_path / "in.usda"), str(tmp_path / target)]) == 0
        assert_same_graph(studio(), read_usd(tmp_path / target))
    assert main(["convert", str(tmp_path / "in.usda"), str(tmp_path / "out.json")]) == 0
    record = json.loads((tmp_path / "out.json").read_text())
    assert record["entities"][0]["name"] == "AREA"
    assert f"{tmp_path / 'out.json'}: 10 entities" in capsys.readouterr().out


def test_instances_as_entities(tmp_path: Path) -> None:
    write_usd(studio(), tmp_path / "in.usda")
    assert main(["convert", str(tmp_path / "in.usda"), str(tmp_path / "out.usda"), "--realize", "-q"]) == 0
    assert len(read_usd(tmp_path / "out.usda")) == 10 + 12


def test_what_is_lost_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", str(NESTED), str(tmp_path / "out.usda"), "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert any("/World/axis/X" in line and "vertex colours are not read" in line for line in record["not_represented"])


def bad_inputs(folder: Path) -> dict[str, Path]:
    write_usd(studio(), folder / "whole.usdc")
    whole = (folder / "whole.usdc").read_bytes()
    made = {
        "half.usdc": whole[: len(whole) // 2], "empty.usda": b"", "text.usda": b"hello", "noise.usdz": bytes(200),
        "deep.usda": b"#usda 1.0\n" + b'def "a" {\n' * 5000 + b"}\n" * 5000,
        "newer.usda": b'#usda 1.0\ndef Xform "S" {\ncustom int unisg:version = 99\n}\n', "scene.txt": b"x",
    }  # fmt: skip
    (folder / "whole.usdc").unlink()
    for name, content in made.items():
        (folder / name).write_bytes(content)
    return {name: folder / name for name in made} | {"missing.usda": folder / "missing.usda", "folder": folder}


@pytest.mark.parametrize("target", ["out.usdc", "out.json", "out.blend"])
def test_inputs_that_cannot_be_used(tmp_path: Path, target: str, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "in").mkdir()
    inputs, out = bad_inputs(tmp_path / "in"), tmp_path / "out"
    out.mkdir()
    for name, path in inputs.items():
        assert main(["convert", str(path), str(out / target)]) == 1, name
        said = capsys.readouterr()
        assert said.out == ""
        assert len(said.err.splitlines()) == 1, said.err
        assert list(out.iterdir()) == []


def test_outputs_that_cannot_be_used(tmp_path: Path) -> None:
    write_usd(studio(), tmp_path / "in.usda")
    before = (tmp_path / "in.usda").read_bytes()
    for target in ("in.usda", "out.fbx", "no folder/out.usda"):
        assert main(["convert", str(tmp_path / "in.usda"), str(tmp_path / target)]) == 1
    assert [path.name for path in tmp_path.iterdir()] == ["in.usda"]
    assert (tmp_path / "in.usda").read_bytes() == before


def test_motion_goes_along(tmp_path: Path) -> None:
    bpy = pytest.importorskip("bpy")
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    item = bpy.data.objects.new("Thing", None)
    bpy.context.scene.collection.objects.link(item)
    for frame in (1, 5):
        item.location.x = frame
        item.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_end = 5
    source = tmp_path / "moving.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(source), copy=True)
    assert main(["convert", str(source), str(tmp_path / "moving.usda"), "-q"]) == 0
    clip = read_usd(tmp_path / "moving.usda")["Thing"].component("animation")
    assert clip["matrices"][0][:, 0, 3] == pytest.approx([1, *clip["matrices"][0][1:-1, 0, 3], 5])
    assert main(["convert", str(source), str(tmp_path / "still.usda"), "-q", "--still"]) == 0
    assert "animation" not in read_usd(tmp_path / "still.usda").components
    assert main(["convert", str(tmp_path / "moving.usda"), str(tmp_path / "again.blend"), "-q"]) == 0
    assert (tmp_path / "again.blend").stat().st_size > 0

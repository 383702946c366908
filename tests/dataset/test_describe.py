from __future__ import annotations

import builtins
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from unisg_blender.cli import main
from unisg_blender.dataset import Sample, write_dataset
from unisg_blender.dataset.dataset_description import describe_dataset, description_lines
from unisg_blender.dataset.format import writer
from unisg_blender.errors import UNUSABLE_INPUT
from unisg_blender.scene import SceneBuilder, SceneGraph


@pytest.fixture
def folder(tmp_path: Path, make_scene: Callable[..., SceneGraph], monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(writer, "SCENES_PER_SHARD", 8)
    monkeypatch.setattr(writer, "CHUNK", 8)
    bare = SceneBuilder("bare")
    bare.add("Empty", uid="e")
    samples = [Sample(make_scene(seed, seed % 5), f"{seed}", "even" if seed % 2 == 0 else "") for seed in range(20)]
    write_dataset([*samples, bare.build()], tmp_path / "ds")
    return tmp_path / "ds"


def test_counts_are_those_of_the_scenes(folder: Path, make_scene: Callable[..., SceneGraph]) -> None:
    scenes = [make_scene(seed, seed % 5) for seed in range(20)]
    names = [scene.category_name(row) for scene in scenes for row in range(len(scene))]
    record = describe_dataset(folder)
    assert json.loads(json.dumps(record)) == record
    assert record["counts"]["scenes"] == 21
    assert record["counts"]["entity"] == len(names) + 1
    assert record["categories"] == {name: names.count(name) for name in record["categories"]}
    assert next(iter(record["categories"])) == "Table"
    assert record["uncategorised"] == names.count("") + 1
    assert record["relations"] == {"on_top_of": sum(seed % 5 for seed in range(20))}
    assert record["scenes"] == {"even": 10}
    assert record["entities_per_scene"] == {"least": 1, "median": 4.0, "most": 6}
    text = "\n".join(description_lines(record))
    assert "21 scenes" in text
    assert "on_top_of" in text


@pytest.mark.slow
def test_inspect_prints_and_draws(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("matplotlib")
    assert main(["inspect", str(folder), "--json", "--figures", str(tmp_path / "figures")]) == 0
    record = json.loads(capsys.readouterr().out)
    assert [Path(path).name for path in record["figures"]] == ["histograms.png", "scenes.png"]
    for path in record["figures"]:
        assert Path(path).read_bytes().startswith(b"\x89PNG")
    assert len(list((tmp_path / "figures").glob("[!.]*"))) == 2
    assert main(["inspect", str(tmp_path)]) == UNUSABLE_INPUT


def test_without_matplotlib_the_install_line_is_shown(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    original = builtins.__import__

    def without(name: str, *args: Any) -> Any:
        if name.startswith("matplotlib"):
            raise ImportError(name)
        return original(name, *args)

    monkeypatch.setattr(builtins, "__import__", without)
    assert main(["inspect", str(folder), "--figures", str(tmp_path / "figures")]) == UNUSABLE_INPUT
    assert 'pip install "unisg-blender[figures]"' in capsys.readouterr().err
    assert not (tmp_path / "figures").exists()

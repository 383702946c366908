"""Which files folders and globs stand for, where scenes were saved as .json."""

from __future__ import annotations

from pathlib import Path

import pytest

from unisg_blender.dataset.export.sources import find_sources
from unisg_blender.errors import UniSGError
from unisg_blender.formats.scene_files import write_scene_file
from unisg_blender.worlds import cubes


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder as ``unisg world --format json`` makes it, with a .json that is no scene."""
    for seed in (0, 1):
        write_scene_file(cubes(seed), tmp_path / f"cubes{seed}.json")
    (tmp_path / "report.jsonl").write_text('{"source": "cubes0"}\n')
    (tmp_path / "notes.json").write_text("{}")
    return tmp_path


def test_a_folder_of_scenes_as_json_is_read(folder: Path) -> None:
    scenes = [folder / "cubes0.json", folder / "cubes1.json"]
    assert find_sources([folder]) == scenes
    assert find_sources([folder / "cubes*.json"]) == scenes
    with pytest.raises(UniSGError, match="there is no scene file"):
        find_sources([folder / "[nr]*"])
    assert find_sources([folder / "*.jsonl"]) == [folder / "report.jsonl"]  # named: its reader says that it is none


def test_json_beside_other_scenes_is_what_it_was_made_of(folder: Path) -> None:
    (folder / "cubes.usda").write_text("#usda 1.0\n")
    assert find_sources([folder]) == [folder / "cubes.usda"]
    assert find_sources([folder / "cubes*"]) == [folder / "cubes.usda"]
    assert len(find_sources([folder / "cubes*.json"])) == 2


def test_a_folder_without_scenes_is_refused(tmp_path: Path) -> None:
    (tmp_path / "notes.json").write_text("{}")
    with pytest.raises(UniSGError, match="there is no scene file"):
        find_sources([tmp_path])

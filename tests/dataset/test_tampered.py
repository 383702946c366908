"""Datasets whose checksums are right and whose contents are not: the reader names what is wrong."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from unisg_blender.dataset import open_dataset, write_dataset
from unisg_blender.dataset.format.columns import Columns
from unisg_blender.dataset.format.schema import COLUMNS, STRINGS, TABLES
from unisg_blender.dataset.format.shards import map_shard, pack_shard
from unisg_blender.errors import UniSGError
from unisg_blender.runtime.atomic_files import checksum
from unisg_blender.worlds import living_room


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("tampered") / "ds"
    write_dataset([living_room(0), living_room(1)], folder)
    return folder


def with_columns(whole: Path, folder: Path, change: Callable[[Columns], Any]) -> Path:
    """A copy with other columns, and a manifest that has their checksum."""
    manifest = json.loads((whole / "manifest.json").read_text())
    entry = manifest["shards"][0]
    shard = map_shard(whole / entry["file"])
    columns = {key: np.array(values) for key, values in shard.columns.items()}
    change(columns)
    data = pack_shard(columns, shard.notes)
    folder.mkdir()
    (folder / entry["file"]).write_bytes(data)
    manifest |= {"shards": [entry | {"sha256": checksum(data)}], "assets": None}
    (folder / "manifest.json").write_text(json.dumps(manifest))
    return folder


def refused(folder: Path, column: str) -> None:
    with pytest.raises(UniSGError, match=f"its column '{column}' is wrong"):
        open_dataset(folder)[0]
    with pytest.raises(UniSGError, match=f"its column '{column}' is wrong"):
        open_dataset(folder, verify=False).check()


def test_what_is_not_changed_is_read(whole: Path, tmp_path: Path) -> None:
    folder = with_columns(whole, tmp_path / "ds", lambda columns: None)
    open_dataset(folder).check()
    assert len(open_dataset(folder)[1]) == len(living_room(1))


OFFSETS = [*(f"{table}.ptr" for table in TABLES), *(f"{key}.offsets" for key in STRINGS)]
ALL = [*COLUMNS, *OFFSETS, *(f"{key}.bytes" for key in STRINGS)]


@pytest.mark.parametrize("key", ALL)
def test_every_column_must_be_there_in_its_type_and_shape(whole: Path, tmp_path: Path, key: str) -> None:
    refused(with_columns(whole, tmp_path / "gone", lambda columns: columns.pop(key)), key)
    refused(with_columns(whole, tmp_path / "type", lambda c: c.update({key: c[key].astype(np.float64)})), key)
    refused(with_columns(whole, tmp_path / "shape", lambda c: c.update({key: c[key][..., None]})), key)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("entity.parent", 1), ("entity.parent", -2), ("entity.category", 10**6), ("entity.type", 100),
        ("entity.mesh", 10**6), ("relation.subject", -1), ("relation.kind", -1), ("relation.target", 10**6),
        ("action.entity", 10**6), ("link.kind", 100), ("link.source", 10**6), ("link.target", -1),
        ("operation.entity", -1), ("scene.label", 5), ("entity.features", np.nan), ("mesh.bounds", np.inf),
        ("entity.ptr", 1), ("entity.name.offsets", 1), ("entity.name.bytes", 0xFF),
    ],
)  # fmt: skip
def test_every_value_must_be_in_its_range(whole: Path, tmp_path: Path, key: str, value: float) -> None:
    def change(columns: Columns) -> None:
        columns[key].reshape(-1)[0] = value

    refused(with_columns(whole, tmp_path / "ds", change), key)


def test_a_name_must_not_begin_within_a_character(whole: Path, tmp_path: Path) -> None:
    def change(columns: Columns) -> None:
        columns["entity.name.bytes"][:2] = list("ä".encode())
        columns["entity.name.offsets"][1] = 1

    refused(with_columns(whole, tmp_path / "ds", change), "entity.name.offsets")


@pytest.mark.parametrize(
    "change",
    [
        {"shards": []}, {"shards": None}, {"vocabulary": {}}, {"mesh_feature_width": 10**12}, {"category_counts": [1]},
        {"counts": {"scenes": -1}}, {"types": 3}, {"files": {"file": "../../etc/passwd", "sha256": ""}},
        {"assets": {"file": "/etc/passwd", "sha256": ""}}, {"software": None},
    ],
)  # fmt: skip
def test_a_manifest_of_another_make_is_refused(whole: Path, tmp_path: Path, change: dict[str, Any]) -> None:
    folder = with_columns(whole, tmp_path / "ds", lambda columns: None)
    record = json.loads((folder / "manifest.json").read_text())
    (folder / "manifest.json").write_text(json.dumps(record | change))
    with pytest.raises(UniSGError, match=r"manifest.json is damaged"):
        open_dataset(folder)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes of POSIX")
def test_a_pipe_is_no_shard_and_no_manifest(whole: Path, tmp_path: Path) -> None:
    folder = with_columns(whole, tmp_path / "ds", lambda columns: None)
    shard = next(folder.glob("scenes-*"))
    shard.unlink()
    os.mkfifo(shard)
    with pytest.raises(UniSGError, match="no plain file"):
        open_dataset(folder)[0]
    (folder / "manifest.json").unlink()
    os.mkfifo(folder / "manifest.json")
    with pytest.raises(UniSGError, match="no plain file"):
        open_dataset(folder)


@pytest.mark.parametrize("overwrite", [False, True])
def test_somebody_elses_manifest_is_not_replaced(tmp_path: Path, overwrite: bool) -> None:
    (tmp_path / "manifest.json").write_text('{"name": "web page"}')
    with pytest.raises(UniSGError, match="of something else"):
        write_dataset([living_room(0)], tmp_path, overwrite=overwrite)
    assert [path.name for path in tmp_path.iterdir()] == ["manifest.json"]


def test_only_files_with_our_names_are_taken_away(tmp_path: Path) -> None:
    write_dataset([living_room(0)], tmp_path)
    mine = {"scenes-mine.safetensors", "assets-of-mine.safetensors", "files-2024.jsonl", "thesis.txt"}
    for name in mine:
        (tmp_path / name).write_text("mine")
    write_dataset([living_room(1)], tmp_path, overwrite=True)
    assert mine <= {path.name for path in tmp_path.iterdir()}
    assert len(list(tmp_path.glob("scenes-0*"))) == 1


def test_a_damaged_dataset_can_be_replaced(whole: Path, tmp_path: Path) -> None:
    folder = with_columns(whole, tmp_path / "ds", lambda columns: None)
    (folder / "manifest.json").write_text(json.dumps({"schema": "unisg-dataset", "shards": 3, "files": "x"}))
    with pytest.raises(UniSGError, match=r"damaged|newer version"):
        open_dataset(folder)
    write_dataset([living_room(1)], folder, overwrite=True)
    open_dataset(folder).check()
    assert len(list(folder.glob("scenes-*"))) == 1

"""``train --data FOLDER`` of scene files, with the categories of ``--mapping``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("torch")

from tests.generate.rooms import room
from unisg_blender.cli import main
from unisg_blender.dataset import open_dataset, write_dataset
from unisg_blender.formats import write_scene_file
from unisg_blender.learn import job_list

NAMES = {"Table": "Desk", "Cup": "Mug"}


@pytest.fixture
def scenes(tmp_path: Path) -> Path:
    """Four rooms without a category, and a mapping that gives some."""
    (tmp_path / "rooms").mkdir()
    for seed in range(4):
        graph = room(seed)
        bare = graph.replace(vocabulary=(), category=graph.category * 0 - 1)
        write_scene_file(bare, tmp_path / "rooms" / f"{seed}.json")
    (tmp_path / "names.json").write_text(json.dumps({"objects": {f"{name}*": kind for name, kind in NAMES.items()}}))
    return tmp_path / "rooms"


@pytest.fixture
def trained(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, Any]]:
    """What a training is given, in order; it trains nothing."""
    found: list[dict[str, Any]] = []

    def train(job: str, datasets: list[Any], out: Path, settings: Any) -> dict[str, Any]:
        for dataset in datasets:
            dataset.check()
            facts = {"name": dataset.path.name, "counts": dataset.category_counts, "path": dataset.path}
            found.append(facts | {"command": settings.command, "sources": [scene.source for scene in dataset]})
        return {"parameters": 0, "scenes_trained": 0, "scenes_held_out": 0, "losses": {}}

    monkeypatch.setattr(job_list, "train", train)
    return found


@pytest.mark.slow
def test_a_folder_of_scenes_is_trained_on_with_the_categories_of_a_mapping(
    scenes: Path, trained: list[dict[str, Any]]
) -> None:
    mapping, out = scenes.parent / "names.json", scenes.parent / "m.onnx"
    words = ["train", "cgvae", "--data", str(scenes), "--out", str(out), "-q"]
    assert main([*words, "--mapping", str(mapping)]) == 0
    (given,) = trained
    expected = {
        kind: sum(text.startswith(name) for seed in range(4) for text in room(seed).name)
        for name, kind in NAMES.items()
    }
    assert given["counts"] == expected
    assert min(expected.values()) > 0
    assert given["name"] == "rooms"
    assert given["command"] == "unisg train cgvae --data rooms --out m.onnx --mapping names.json --seed 0"
    assert [Path(source).name for source in given["sources"]] == [f"{seed}.json" for seed in range(4)]
    assert not given["path"].exists()


@pytest.mark.slow
def test_without_a_mapping_there_are_the_scenes_own_categories(scenes: Path, trained: list[dict[str, Any]]) -> None:
    assert main(["train", "cgvae", "--data", str(scenes), "--out", str(scenes.parent / "m.onnx"), "-q"]) == 0
    assert trained[0]["counts"] == {}


@pytest.mark.slow
def test_datasets_and_folders_are_learned_from_together(scenes: Path, trained: list[dict[str, Any]]) -> None:
    write_dataset([room(9)], scenes.parent / "made")
    words = ["train", "topology", "--data", str(scenes.parent / "made"), str(scenes), "-q"]
    words += ["--mapping", str(scenes.parent / "names.json"), "--out", str(scenes.parent / "m.onnx")]
    assert main(words) == 0
    assert trained[0]["counts"] == open_dataset(scenes.parent / "made").category_counts
    assert set(trained[1]["counts"]) == set(NAMES.values())


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (("cgvae", "--data", "made", "--mapping", "names.json"), "made is a dataset, in which --mapping changes"),
        (("cgvae", "--data", "made", "--assets", "rooms"), "made is a dataset, in which --assets changes nothing"),
        (("cgvae", "--data", "rooms", "--mapping", "none.json"), "cannot read the mapping none.json"),
        (("cgvae", "--data", "rooms", "--devices", "2"), "several devices learn from datasets"),
        (("cgvae", "--data", "rooms", "--nodes", "2"), "several devices learn from datasets"),
        (("cgvae", "--data", "empty"), "empty holds neither a dataset nor a scene file"),
        (("cgvae", "--data", "none"), "there is no file or folder none: check the path"),
        pytest.param(("cgvae", "--data", "few"), "few has 1 scenes: a generator needs 4", marks=pytest.mark.slow),
        pytest.param(("cgvae", "--data", "broken"), "1 of 2 scene files cannot be read; ", marks=pytest.mark.slow),
        (("meshes", "--data", "rooms", "--mapping", "names.json"), "'train meshes' reads mesh files"),
        (("meshes", "--data", "rooms", "--assets", "rooms"), "'train meshes' reads mesh files"),
    ],
)
def test_what_would_change_nothing_or_cannot_be_read_is_refused_in_a_line(
    scenes: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], words: tuple[str, ...], text: str
) -> None:
    monkeypatch.chdir(scenes.parent)
    write_dataset([room(9)], scenes.parent / "made")
    for name in ("empty", "broken"):
        Path(name).mkdir()
    write_scene_file(room(1), Path("broken/1.json"))
    Path("broken/0.json").write_bytes(Path("broken/1.json").read_bytes()[:-9])
    Path("few").mkdir()
    write_scene_file(room(1), Path("few/1.json"))
    out = "out" if words[0] == "meshes" else "m.onnx"
    before = sorted(Path().rglob("*"))
    assert main(["train", *words, "--out", out, "-q"]) == 1
    error = capsys.readouterr().err
    assert text in error
    assert error.count("\n") == 1
    assert sorted(Path().rglob("*")) == before

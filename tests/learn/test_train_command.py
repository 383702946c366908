"""The verb ``train cgvae``: provenance in the file, resume, and plain words for bad input."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

pytest.importorskip("torch")
pytest.importorskip("pytorch_lightning")

from tests.generate.models import trained, write_rooms
from unisg_blender.cli import main
from unisg_blender.dataset import write_dataset
from unisg_blender.generate.model import assets_path, load_model
from unisg_blender.scene import SceneBuilder


def test_a_model_says_where_it_comes_from(
    dataset_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "model.onnx"
    words = ["train", "cgvae", "--data", str(dataset_folder), "--out", str(out), "--paper", "--form", "pga_even"]
    logs = tmp_path / "logs"
    assert main([*words, "--epochs", "2", "--seed", "7", "--logs", str(logs), "--json", "-q"]) == 0
    report = json.loads(capsys.readouterr().out)
    contract = load_model(out).contract
    assert (contract.kind, contract.form) == ("cgvae", "pga_even")
    assert contract.provenance["dataset"]["scenes"] == 12
    assert contract.provenance["settings"]["seed"] == 7
    assert contract.provenance["losses"] == report["losses"]
    assert contract.provenance["predict_mean"]["mse"] > 0
    assert str(tmp_path) not in json.dumps(contract.provenance)
    assert any("few" in note for note in report["notes"])
    assert assets_path(out).is_file()
    assert (logs / "metrics.csv").read_text().count("\n") >= 3
    assert sorted(path.suffix for path in tmp_path.iterdir() if path.is_file()) == [".onnx", ".safetensors"]


def test_same_seed_same_model(model_file: Path, dataset_folder: Path, tmp_path: Path) -> None:
    import onnx

    paper = load_model(model_file).contract.kind == "cgvae"
    again = trained(dataset_folder, tmp_path / "again.onnx", paper)
    one, two = (onnx.load(path).graph.initializer for path in (model_file, again))
    assert [weight.raw_data for weight in one] == [weight.raw_data for weight in two]


def test_training_goes_on_where_it_stopped(dataset_folder: Path, tmp_path: Path) -> None:
    import torch

    words = ["train", "cgvae", "--data", str(dataset_folder), "--out", str(tmp_path / "m.onnx"), "--paper", "-q"]
    for epochs in (1, 3):
        assert main([*words, "--epochs", str(epochs), "--logs", str(tmp_path / "logs")]) == 0
    last = torch.load(tmp_path / "logs" / "last.ckpt", weights_only=False)
    assert last["epoch"] == 2


@pytest.mark.parametrize(
    ("scenes", "text"),
    [(2, "has 2 scenes"), (0, "holds no dataset"), (-1, "at least two categories")],
)
def test_what_cannot_be_learned_from_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], scenes: int, text: str
) -> None:
    folder = tmp_path / "dataset"
    if scenes > 0:
        write_rooms(folder, scenes)
    elif scenes < 0:
        builder = SceneBuilder("Bare")
        builder.add("Empty", uid="e", category="Thing")
        write_dataset([builder.build()] * 5, folder)
    assert main(["train", "cgvae", "--data", str(folder), "--out", str(tmp_path / "m.onnx"), "-q"]) == 1
    error = capsys.readouterr().err
    assert text in error
    assert error.count("\n") == 1
    assert not (tmp_path / "m.onnx").exists()


def test_bad_options_are_told(dataset_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["train", "cgvae", "--data", str(dataset_folder)]
    assert main([*words, "--out", str(tmp_path / "model.pt")]) == 1
    assert main([*words, "--out", str(tmp_path / "missing" / "model.onnx")]) == 1
    assert main([*words, "--out", str(tmp_path / "model.onnx"), "--epochs", "0"]) == 1
    assert capsys.readouterr().err.count("\n") == 3
    assert main([*words, "--out", str(tmp_path / "model.onnx"), "--form", "euler"]) == 2

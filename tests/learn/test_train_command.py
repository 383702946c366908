"""The verb ``train cgvae``: provenance in the file, resume, and plain words for bad input."""

from __future__ import annotations

import json
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

torch = pytest.importorskip("torch")
pytest.importorskip("torch_geometric")
pytest.importorskip("pytorch_lightning")

from tests.generate.models import write_rooms  # noqa: E402
from unisg_blender.cli import main  # noqa: E402
from unisg_blender.dataset import open_dataset, write_dataset  # noqa: E402
from unisg_blender.errors import UniSGError  # noqa: E402
from unisg_blender.generate.propose.trained_model import assets_path, load_model  # noqa: E402
from unisg_blender.learn import job_list  # noqa: E402
from unisg_blender.learn.anchors import training as train_anchors  # noqa: E402
from unisg_blender.learn.behaviour import training as train_behaviour  # noqa: E402
from unisg_blender.learn.cgvae import training as train_cgvae  # noqa: E402
from unisg_blender.learn.hyperparameters import Settings  # noqa: E402
from unisg_blender.scene import SceneBuilder  # noqa: E402

pytestmark = pytest.mark.slow


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
    names = ["model.assets.safetensors", "model.behaviour.onnx", "model.onnx"]
    assert sorted(path.name for path in tmp_path.iterdir() if path.is_file()) == names


def test_json_stands_alone_and_what_to_expect_is_told_before_the_training(
    dataset_folder: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    words = ["train", "cgvae", "--data", str(dataset_folder), "--out", str(tmp_path / "model.onnx"), "--paper"]
    assert main([*words, "--epochs", "2", "--json"]) == 0
    out, err = capfd.readouterr()
    assert json.loads(out)["scenes_trained"] == 11
    assert err.index("note: 12 scenes are few") < err.index(" steps")
    assert "epoch 2, loss" in err


def networks(monkeypatch: pytest.MonkeyPatch) -> list[torch.nn.Module]:
    """What is trained from here on, in order; nothing is exported."""
    found: list[torch.nn.Module] = []
    for module, name in ((train_cgvae, "write_cgvae"), (train_anchors, "write_anchors")):
        monkeypatch.setattr(module, name, lambda network, contract, out: found.append(network))
    monkeypatch.setattr(train_anchors, "PER_EPOCH", 64)
    monkeypatch.setattr(train_behaviour, "train_beside", lambda datasets, model, settings: {"notes": []})
    return found


@pytest.mark.parametrize("paper", [True, False])
def test_same_seed_same_network_and_another_seed_another(
    dataset_folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, paper: bool
) -> None:
    found = networks(monkeypatch)
    for seed in (3, 3, 4):
        settings = Settings(paper=paper, epochs=1, seed=seed, quiet=True)
        job_list.train("cgvae", [open_dataset(dataset_folder)], tmp_path / "model.onnx", settings)
    one, two, other = (torch.cat([weight.flatten() for weight in network.parameters()]) for network in found)
    assert torch.equal(one, two)
    assert not torch.allclose(one, other)


@pytest.mark.parametrize("module", [train_cgvae, train_anchors])
def test_an_interrupted_training_goes_on_where_it_stopped(
    dataset_folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, module: ModuleType
) -> None:
    networks(monkeypatch)
    logs, real, calls = tmp_path / "logs", module.terms, []

    def failing(network: torch.nn.Module, batch: Any) -> dict[str, torch.Tensor]:
        calls.append(1)
        if len(calls) > 4:  # a training step and a validation step in each epoch
            raise RuntimeError("the power fails")
        return real(network, batch)

    def train(epochs: int) -> None:
        settings = Settings(paper=module is train_cgvae, epochs=epochs, quiet=True, logs=logs)
        job_list.train("cgvae", [open_dataset(dataset_folder)], tmp_path / "model.onnx", settings)

    monkeypatch.setattr(module, "terms", failing)
    with pytest.raises(RuntimeError, match="power"):
        train(4)
    monkeypatch.setattr(module, "terms", real)
    with pytest.raises(UniSGError, match="same dataset and --epochs"):
        train(6)
    train(4)
    assert torch.load(logs / "last.ckpt", weights_only=True)["epoch"] == 3
    epochs = {line.split(",")[0] for line in (logs / "metrics.csv").read_text().splitlines()[1:]}
    assert epochs == {"2", "3"}
    assert (logs / "metrics-1.csv").is_file()


@pytest.mark.parametrize(
    ("scenes", "text"),
    [(2, "has 2 scenes"), (0, "there is no file or folder"), (-1, "at least two categories")],
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

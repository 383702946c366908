"""The verbs ``train topology`` and ``train classifier``: the same in ONNX, seeds, resume, early stop, two processes."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")
pytest.importorskip("torch_geometric")
pytest.importorskip("pytorch_lightning")

from torch_geometric.data import Batch  # noqa: E402

from unisg_blender.cli import main  # noqa: E402
from unisg_blender.dataset import open_dataset, write_dataset  # noqa: E402
from unisg_blender.learn import job_list  # noqa: E402
from unisg_blender.learn.hyperparameters import Settings  # noqa: E402
from unisg_blender.learn.scene_classifier import training as train_classifier  # noqa: E402
from unisg_blender.learn.topology import training as train_topology  # noqa: E402
from unisg_blender.predict.object_pairs import PAIR_CHANNELS  # noqa: E402
from unisg_blender.predict.prediction_session import VERSION, load_network  # noqa: E402
from unisg_blender.runtime.onnx_session import metadata_text  # noqa: E402
from unisg_blender.worlds import cubes, living_room  # noqa: E402

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, Path]]:
    """Small datasets: cubes, and living rooms to tell them from."""
    root = tmp_path_factory.mktemp("scenes")
    write_dataset((cubes(seed, 12) for seed in range(12)), root / "cubes", "trs_matrix")
    write_dataset((living_room(seed) for seed in range(3)), root / "living-room", "quaternion")
    return {"cubes": root / "cubes", "living-room": root / "living-room"}


def test_topology_in_the_file_is_that_of_torch(folders: dict[str, Path], tmp_path: Path) -> None:
    torch.manual_seed(0)
    pairs = train_topology.joined([train_topology.pairs_of(cubes(seed, 10)) for seed in range(2)])
    network = train_topology.PairNetwork(pairs.features.mean(axis=0), pairs.features.std(axis=0) + 0.1).eval()
    train_topology.write_topology(network, 0.5, {}, tmp_path / "m.onnx")
    loaded = load_network("topology", tmp_path / "m.onnx")
    for count in (1, 2, 77):
        some = pairs.features[:count]
        with torch.no_grad():
            np.testing.assert_allclose(
                loaded.run(features=some)[0], network(torch.from_numpy(some)).numpy(), atol=1e-5, rtol=1e-5
            )
    assert pairs.features.shape[1] == len(PAIR_CHANNELS)
    assert 0 < pairs.truth.sum() < len(pairs.truth)
    assert pairs.missed == 0


def test_the_classifier_in_the_file_is_that_of_torch(folders: dict[str, Path], tmp_path: Path) -> None:
    datasets = [open_dataset(path) for path in folders.values()]
    kinds, scenes = train_classifier.load_labelled(datasets, "sixd", "descriptor", quiet=True)
    assert kinds == ["cubes", "living-room"]
    torch.manual_seed(0)
    network = train_classifier.StandaloneClassifier(*train_classifier.normalisation(scenes), len(kinds)).eval()
    metadata = metadata_text("classifier", VERSION, kinds=kinds, form="sixd", mesh="descriptor")
    train_classifier.write_classifier(network, metadata, tmp_path / "m.onnx")
    loaded = load_network("classifier", tmp_path / "m.onnx")
    with torch.no_grad():
        together = network.of_batch(Batch.from_data_list([scene.graph for scene in scenes])).numpy()
    for number in (0, 5, 13):  # cubes have no actions, rooms do
        graph = scenes[number].graph
        inputs = {node: graph[node].x.numpy() for node in train_classifier.NODES}
        inputs |= {name: graph[edge].edge_index.numpy() for name, edge in train_classifier.EDGES.items()}
        logits = loaded.run(**inputs)[0]
        np.testing.assert_allclose(logits[0], together[number], atol=1e-5, rtol=1e-4)


def test_turning_a_scene_changes_only_the_poses_of_its_roots(folders: dict[str, Path]) -> None:
    _, scenes = train_classifier.load_labelled([open_dataset(p) for p in folders.values()], "sixd", "descriptor", True)
    before = scenes[0].graph["trs"].x.clone()
    turned = train_classifier.LabelledScenes(scenes[:1], "sixd", turned=True, seed=0)[0]
    moved = torch.nonzero((turned["trs"].x - before).abs().amax(1) > 1e-6).flatten()
    assert moved.tolist() == scenes[0].roots.tolist()
    assert torch.equal(scenes[0].graph["trs"].x, before)  # the scene itself is as it was


@pytest.mark.parametrize("job", ["topology", "classifier"])
def test_same_seed_same_network(
    folders: dict[str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, job: str
) -> None:
    module = {"topology": train_topology, "classifier": train_classifier}[job]
    found = []
    monkeypatch.setattr(module, f"write_{job}", lambda network, *rest: found.append(network))
    datasets = [open_dataset(path) for path in folders.values()]
    for seed in (1, 1, 2):
        job_list.train(job, datasets, tmp_path / "m.onnx", Settings(epochs=1, seed=seed, quiet=True))
    one, two, other = (torch.cat([weight.flatten() for weight in network.parameters()]) for network in found)
    assert torch.equal(one, two)
    assert not torch.allclose(one, other)


def test_what_is_trained_can_be_asked(
    folders: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["--data", *map(str, folders.values()), "--json", "-q"]
    logs = tmp_path / "logs"
    assert (
        main(["train", "topology", *words, "--out", str(tmp_path / "t.onnx"), "--epochs", "3", "--logs", str(logs)])
        == 0
    )
    report = json.loads(capsys.readouterr().out)
    assert report["test"]["edges"] > 0
    assert 0 < report["test"]["average_precision"] <= 1
    assert [item["name"] for item in report["datasets"]] == ["cubes", "living-room"]
    assert (logs / "metrics.csv").is_file()
    assert list((logs / "tensorboard").glob("events.out.tfevents*"))
    assert main(["train", "classifier", *words, "--out", str(tmp_path / "c.onnx"), "--epochs", "4"]) == 0
    assert json.loads(capsys.readouterr().out)["losses"]["val_accuracy"] >= 0.5
    assert main(["train", "topology", *words, "--out", str(tmp_path / "t.onnx"), "--paper"]) == 1
    assert main(["train", "classifier", *words, "--out", str(tmp_path / "c.onnx"), "--paper"]) == 1
    assert "mesh features" in capsys.readouterr().err
    assert main(["train", "classifier", "--data", str(folders["cubes"]), "--out", str(tmp_path / "c.onnx"), "-q"]) == 1


def test_training_ends_early_and_keeps_the_best(
    folders: dict[str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept = []
    monkeypatch.setattr(train_topology, "write_topology", lambda network, *rest: kept.append(network))
    values, weights = [3.0, 1.0, 2.0, 2.0, 2.0, 2.0], []

    def terms(network: torch.nn.Module, batch: list[torch.Tensor]) -> dict[str, torch.Tensor]:
        loss = network(batch[0]).square().mean()
        if not network.training:  # validation: losses as listed, one per epoch
            weights.append(network.layers[0].weight.detach().clone())
            loss = loss * 0 + values[len(weights) - 1]
        return {"loss": loss}

    monkeypatch.setattr(train_topology, "terms", terms)
    monkeypatch.setattr(train_topology, "BATCH", 100_000)
    datasets = [open_dataset(folders["cubes"])]
    job_list.train("topology", datasets, tmp_path / "m.onnx", Settings(epochs=6, patience=2, quiet=True))
    assert len(weights) == 4
    assert torch.equal(kept[0].layers[0].weight.detach(), weights[1])


def test_two_processes_reach_the_loss_of_one(folders: dict[str, Path], tmp_path: Path) -> None:
    losses = {}
    environment = os.environ | {"OMP_NUM_THREADS": "1", "CUDA_VISIBLE_DEVICES": ""}
    for devices in (1, 2):
        out = tmp_path / f"{devices}.onnx"
        words = [
            "train",
            "topology",
            "--data",
            str(folders["cubes"]),
            "--out",
            str(out),
            "--epochs",
            "3",
            "--json",
            "-q",
        ]
        done = subprocess.run(
            [sys.executable, "-W", "ignore", "-m", "unisg_blender", *words, "--devices", str(devices)],
            capture_output=True, text=True, timeout=280, env=environment, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr[-2000:]
        lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
        assert len(lines) == 1  # only the first process reports and writes
        losses[devices] = json.loads(lines[0])["losses"]
        assert out.is_file()
    assert losses[1]["train_loss"] == pytest.approx(losses[2]["train_loss"], rel=0.02)
    assert losses[1]["val_loss"] == pytest.approx(losses[2]["val_loss"], rel=0.02)

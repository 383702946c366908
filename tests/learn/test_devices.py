"""Networks and losses make all tensors where their inputs are: in a world whose own device is another one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

torch = pytest.importorskip("torch")
pytest.importorskip("torch_geometric")
pytest.importorskip("pytorch_lightning")

from tests.generate.rooms import room  # noqa: E402
from unisg_blender.dataset import open_dataset, write_dataset  # noqa: E402
from unisg_blender.errors import UniSGError  # noqa: E402
from unisg_blender.generate.behaviour.action_statistics import learn_kinds  # noqa: E402
from unisg_blender.learn import job_list  # noqa: E402
from unisg_blender.learn.anchors.training import example_inputs as anchor_inputs  # noqa: E402
from unisg_blender.learn.atiss.training import example_inputs as atiss_inputs  # noqa: E402
from unisg_blender.learn.atlasnet.network import AtlasNet  # noqa: E402
from unisg_blender.learn.behaviour.training import example_inputs as behaviour_inputs  # noqa: E402
from unisg_blender.learn.behaviour.training import make_network  # noqa: E402
from unisg_blender.learn.cgvae.sampled_pairs import sample_pairs  # noqa: E402
from unisg_blender.learn.ensemble import StackedMlp, train_stacked  # noqa: E402
from unisg_blender.learn.hyperparameters import Settings, accelerator_device  # noqa: E402
from unisg_blender.learn.losses.chamfer import chamfer  # noqa: E402
from unisg_blender.learn.scene_classifier.training import example_inputs as classifier_inputs  # noqa: E402
from unisg_blender.learn.training_job import Prepared  # noqa: E402
from unisg_blender.worlds import cubes, living_room  # noqa: E402

MODELS = ("anchors", "atiss", "behaviour", "cgvae", "scene_classifier", "topology")


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> Sequence[Path]:
    root = tmp_path_factory.mktemp("scenes")
    write_dataset((room(seed) for seed in range(12)), root / "rooms")
    write_dataset((living_room(seed) for seed in range(3)), root / "living")
    write_dataset((cubes(seed, 8) for seed in range(12)), root / "cubes", "trs_matrix")
    return [root / "rooms", root / "living", root / "cubes"]


def prepared(model: str, folders: Sequence[Path]) -> tuple[Any, Prepared]:
    """The module of a model, and its network before the first step."""
    chosen = {"scene_classifier": folders[:2], "topology": folders[2:]}.get(model, folders[:1])
    module = job_list.load(f"{model}.training")
    settings = Settings(epochs=1, form=module.FORM, quiet=True)
    return module, module.prepare([open_dataset(path) for path in chosen], settings)


def elsewhere(compute: Callable[[], dict[str, torch.Tensor]]) -> None:
    """What is computed is the same, and on the CPU, where tensors made without a device go to another one."""
    torch.manual_seed(0)
    expected = compute()
    torch.manual_seed(0)
    with torch.device("meta"):
        found = compute()
    assert found.keys() == expected.keys()
    for name, value in found.items():
        assert value.device.type == "cpu", name
        assert torch.equal(value, expected[name]), name


@pytest.mark.slow
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("training", [True, False])
def test_losses_and_their_gradients_stay_where_the_batch_is(
    folders: Sequence[Path], model: str, training: bool
) -> None:
    module, ready = prepared(model, folders)
    batch, network = next(iter(ready.loaders[0])), ready.network.train(training)

    def terms() -> dict[str, torch.Tensor]:
        network.zero_grad()
        found = module.terms(network, batch)
        found["loss"].backward()
        gradients = {name: weight.grad for name, weight in network.named_parameters() if weight.grad is not None}
        return {**{name: value.detach() for name, value in found.items()}, **gradients}

    elsewhere(terms)


def test_an_input_on_another_device_is_found_out() -> None:
    with pytest.raises((RuntimeError, AssertionError)), torch.device("meta"):
        elsewhere(lambda: {"sum": torch.ones(3, device="cpu") + torch.arange(3)})


@pytest.mark.parametrize("model", [model for model in MODELS if model != "cgvae"])  # PyG's GCNConv looks at values
def test_a_whole_network_works_on_another_device(folders: Sequence[Path], model: str) -> None:
    _, ready = prepared(model, folders)
    examples = {
        "anchors": lambda: anchor_inputs(ready.network),
        "atiss": lambda: dict(atiss_inputs()),
        "behaviour": lambda: behaviour_inputs(ready.contract),
        "scene_classifier": lambda: classifier_inputs(ready.network),
        "topology": lambda: {"features": torch.zeros(3, len(ready.network.mean))},
    }
    inputs = {name: value.to("meta") for name, value in examples[model]().items()}
    outputs = ready.network.eval().to("meta")(**inputs)
    for output in outputs if isinstance(outputs, tuple) else (outputs,):
        assert output.device.type == "meta"


def test_meshes_pairs_and_ensembles_stay_where_they_are() -> None:
    torch.manual_seed(0)
    network, points = AtlasNet(patches=4), torch.randn(2, 40, 3)
    parent, scene = torch.tensor([-1, 0, 0, -1, 3, 3]), torch.tensor([0, 0, 0, 1, 1, 1])
    x = torch.randn(1, 20, 3)

    def compute() -> dict[str, torch.Tensor]:
        decoded = network(points, 30, np.random.default_rng(0))
        draw = torch.Generator().manual_seed(0)
        stacked = StackedMlp(3, 2, [0], (4, 4)).to_empty(device="cpu")
        with torch.no_grad():
            for weight in stacked.parameters():
                weight.fill_(0.1)
        train_stacked(stacked, x, x[..., :2], [0.01], lambda a, b: (a - b).square().mean((1, 2)), [0], 2, 5)
        pairs = vars(sample_pairs(parent, scene, 2, draw))
        tensors = {name: value for name, value in pairs.items() if isinstance(value, torch.Tensor)}
        weights = {f"weight{number}": weight.detach() for number, weight in enumerate(stacked.parameters())}
        return {"chamfer": chamfer(decoded, points).detach(), **tensors, **weights}

    elsewhere(compute)
    first, second = torch.zeros(2, 5, 3, device="meta"), torch.zeros(2, 7, 3, device="meta")
    assert chamfer(first, second).device.type == "meta"
    assert AtlasNet(patches=4).to("meta")(first, 30, np.random.default_rng(0)).device.type == "meta"


def test_behaviour_of_scenes_without_missing_actions_is_elsewhere_too() -> None:
    kinds = learn_kinds([living_room(0)])
    network = make_network(kinds)
    inputs = behaviour_inputs(kinds)
    batch = {**inputs, "wanted": torch.zeros(1, len(kinds.kinds)), "able": torch.ones(1, len(kinds.kinds))}
    batch["made"] = torch.zeros(0, 6, dtype=torch.int64)
    terms = job_list.load("behaviour.training").terms
    elsewhere(lambda: {name: value.detach() for name, value in terms(network, batch).items()})


def test_the_accelerator_is_what_is_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(torch.accelerator, "is_available", lambda: False)
    assert accelerator_device("auto").type == accelerator_device("cpu").type == "cpu"
    with pytest.raises(UniSGError, match="no GPU"):
        accelerator_device("gpu")
    monkeypatch.setattr(torch.accelerator, "is_available", lambda: True)
    monkeypatch.setattr(torch.accelerator, "current_accelerator", lambda: torch.device("cuda"))
    assert accelerator_device("auto").type == accelerator_device("gpu").type == "cuda"
    assert accelerator_device("cpu").type == "cpu"

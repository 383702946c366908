"""A folder of logs may come from anybody: what a checkpoint holds is loaded, never run."""

from __future__ import annotations

import pickle
from pathlib import Path

import pytest

torch = pytest.importorskip("torch")
pytest.importorskip("pytorch_lightning")

from unisg_blender.errors import UniSGError  # noqa: E402
from unisg_blender.learn.hyperparameters import Settings  # noqa: E402
from unisg_blender.learn.trainer import Schedule, fit, loader  # noqa: E402

pytestmark = pytest.mark.slow


def train(logs: Path, width: int = 1, epochs: int = 1) -> dict[str, float]:
    settings = Settings(epochs=epochs, logs=logs, quiet=True, accelerator="cpu")
    loaders = [loader([torch.ones(2)] * 4, 2, settings, shuffle) for shuffle in (True, False)]
    network = torch.nn.Linear(2, width)
    return fit(network, lambda net, batch: {"loss": net(batch).square().mean()}, loaders, Schedule(), settings)


class Poison:
    """Makes a file when it is unpickled."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __reduce__(self) -> tuple[object, tuple[object, ...]]:
        return Path.touch, (self.path,)


@pytest.mark.parametrize("how", ["pickle", "all of it", "beside weights", "cut", "list", "empty"])
def test_a_poisoned_checkpoint_is_refused_and_not_run(tmp_path: Path, how: str) -> None:
    logs, ran = tmp_path / "logs", tmp_path / "ran"
    train(logs)
    last = logs / "last.ckpt"
    data, whole = last.read_bytes(), torch.load(last, weights_only=True)
    last.write_bytes({"pickle": pickle.dumps(Poison(ran)), "cut": data[:2000]}.get(how, b""))
    saved = {"all of it": Poison(ran), "beside weights": whole | {"loops": Poison(ran)}, "list": [1, 2]}
    if how in saved:
        torch.save(saved[how], last)
    with pytest.raises(UniSGError, match="is no checkpoint of a training") as told:
        train(logs)
    assert "\n" not in str(told.value)
    assert not ran.exists()
    if how in ("all of it", "beside weights"):
        torch.load(last, weights_only=False)
        assert ran.exists(), "the poison is none"


def test_a_training_goes_on_from_its_own_checkpoint_only(tmp_path: Path) -> None:
    train(tmp_path / "logs", epochs=2)
    train(tmp_path / "logs", epochs=2)
    with pytest.raises(UniSGError, match="logs are of another network"):
        train(tmp_path / "logs", width=3, epochs=2)
    with pytest.raises(UniSGError, match="logs are of a training of"):
        train(tmp_path / "logs", epochs=3)

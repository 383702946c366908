"""The trainer: the only place that knows Lightning."""

from __future__ import annotations

import logging
import signal
import tempfile
import threading
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytorch_lightning as lightning
import torch
from pytorch_lightning.callbacks import Callback, EarlyStopping, ModelCheckpoint
from pytorch_lightning.loggers import CSVLogger, TensorBoardLogger
from torch import Tensor, nn
from torch.utils.data import DataLoader
from torch.utils.data.distributed import DistributedSampler

from ..errors import UniSGError
from ..runtime.progress import Progress
from .hyperparameters import Settings, accelerator_device

Terms = Callable[[nn.Module, Any], Mapping[str, Tensor]]
"""Loss terms of a batch by name; "loss" is what is minimised."""


@dataclass(frozen=True)
class Schedule:
    """How fast: one cycle of the learning rate, 10 % of it warm-up.

    AdamW for all but the matrices named in ``muon``, which Muon trains: it orthogonalises what momentum has
    gathered (Jordan et al., "Muon: An optimizer for hidden layers in neural networks", 2024). It ends after all
    epochs, or after ``steps``.
    """

    rate: float = 2e-3
    muon: Sequence[nn.Parameter] = ()
    weight_decay: float = 0.01
    clip: float = 2.0
    steps: int = -1


class _Task(lightning.LightningModule):
    def __init__(self, network: nn.Module, terms: Terms, schedule: Schedule) -> None:
        super().__init__()
        self.network, self.terms, self.schedule = network, terms, schedule
        self.automatic_optimization = False  # there may be two optimizers
        self.seen: dict[str, list[Tensor]] = {}
        self.at_end = signal.getsignal(signal.SIGTERM)

    def on_fit_start(self) -> None:
        """Let SIGTERM mean again what it meant before Lightning took it: there it ends an epoch as if all were done."""
        if threading.current_thread() is threading.main_thread():
            signal.signal(signal.SIGTERM, self.at_end)

    def training_step(self, batch: Any, _: int) -> None:
        """One step of all optimizers on one batch."""
        optimizers, cycles = _all(self.optimizers()), _all(self.lr_schedulers())
        for optimizer in optimizers:
            optimizer.zero_grad()
        self.manual_backward(self._step(batch, "train"))
        nn.utils.clip_grad_norm_(self.parameters(), self.schedule.clip)
        for part in (*optimizers, *cycles):
            part.step()

    def validation_step(self, batch: Any, _: int) -> None:
        """The loss terms of one batch, kept."""
        self._step(batch, "val")

    def _step(self, batch: Any, stage: str) -> Tensor:
        """The loss; terms are kept until the epoch ends, since it takes long to log each at every step."""
        terms = self.terms(self.network, batch)
        for name, value in terms.items():
            self.seen.setdefault(f"{stage}_{name}", []).append(value.detach())
        return terms["loss"]

    def on_train_epoch_end(self) -> None:
        """Log the means of the epoch."""
        self._report("train")

    def on_validation_epoch_end(self) -> None:
        """Log the means of the epoch's validation."""
        self._report("val")

    def _report(self, stage: str) -> None:
        """Log the means of a stage's terms."""
        for name in [name for name in self.seen if name.startswith(stage)]:
            mean = torch.stack(self.seen.pop(name)).mean()
            self.log(name, mean, prog_bar=name == "train_loss", sync_dist=self.trainer.world_size > 1)

    def on_load_checkpoint(self, checkpoint: dict[str, Any]) -> None:
        """Refuse to go on with another network, or with a training of another length."""
        own, found = self.state_dict(), checkpoint["state_dict"]
        if {name: value.shape for name, value in own.items()} != {
            name: getattr(value, "shape", None) for name, value in found.items()
        }:
            raise UniSGError("the logs are of another network: give the same dataset and options, or another --logs")
        schedules = checkpoint.get("lr_schedulers") or [{}]
        steps, before = int(self.trainer.estimated_stepping_batches), schedules[0].get("total_steps")
        if steps != before:
            raise UniSGError(
                f"the logs are of a training of {before} steps, this one has {steps}: "
                "give the same dataset and --epochs, or another --logs"
            )

    def configure_optimizers(self) -> Any:
        """AdamW and, if there are matrices for it, Muon, each with its cycle of rates."""
        plan, chosen = self.schedule, {id(matrix) for matrix in self.schedule.muon}
        others = [part for part in self.parameters() if id(part) not in chosen]
        optimizers: list[torch.optim.Optimizer] = [torch.optim.AdamW(others, plan.rate, weight_decay=plan.weight_decay)]
        if plan.muon:
            like = "match_rms_adamw"
            optimizers.append(torch.optim.Muon(plan.muon, plan.rate, plan.weight_decay, adjust_lr_fn=like))
        steps = max(int(self.trainer.estimated_stepping_batches), 2)
        cycles = [
            torch.optim.lr_scheduler.OneCycleLR(
                optimizer, plan.rate, total_steps=steps, pct_start=0.1,
                cycle_momentum=isinstance(optimizer, torch.optim.AdamW),
            )
            for optimizer in optimizers
        ]  # fmt: skip
        return optimizers, cycles


def _all(parts: Any) -> list[Any]:
    return parts if isinstance(parts, list) else [parts]


class _StepsBar(Callback):
    """How far the training is, on stderr: Lightning's own bar prints where reports go."""

    def __init__(self) -> None:
        self.bar: Progress | None = None
        self.done = 0

    def on_train_start(self, trainer: Any, pl_module: Any) -> None:
        """Begin the bar, at the step from which an interrupted training goes on."""
        self.done = trainer.current_epoch * trainer.num_training_batches
        self.bar = Progress(int(trainer.estimated_stepping_batches), "steps", quiet=not trainer.is_global_zero)

    def on_train_epoch_start(self, trainer: Any, pl_module: Any) -> None:
        """Name the epoch, and the loss of the one before."""
        assert self.bar is not None
        loss = trainer.callback_metrics.get("train_loss")
        self.bar.say(f"epoch {trainer.current_epoch + 1}" + ("" if loss is None else f", loss {float(loss):.4f}"))

    def on_train_batch_end(self, trainer: Any, pl_module: Any, outputs: Any, batch: Any, batch_idx: int) -> None:
        """One step more."""
        assert self.bar is not None
        self.done += 1
        self.bar.update(self.done)

    def teardown(self, trainer: Any, pl_module: Any, stage: str) -> None:
        """End the bar, also of a training that failed."""
        if self.bar is not None:
            self.bar.close()


class _BestLosses(Callback):
    def __init__(self) -> None:
        self.last: dict[str, float] = {}

    def on_train_end(self, trainer: Any, pl_module: Any) -> None:
        """Keep the last values."""
        self.last = {name: float(value) for name, value in trainer.callback_metrics.items()}


def loader(
    items: Any, batch: int, settings: Settings, shuffle: bool, collate: Callable[[Any], Any] | None = None,
    workers: int = 0,
) -> DataLoader[Any]:  # fmt: skip
    """Batches of ``batch`` of a sequence's items in all, however many processes share them.

    Several processes together see in each step what one process would see, so that their losses agree.
    """
    processes = settings.devices * settings.nodes
    alone = shuffle and processes == 1
    sampler: DistributedSampler[Any] | None = None
    if alone:
        sampler = DistributedSampler(items, 1, 0, shuffle=True, seed=settings.seed)
    size = max(1, batch // processes)
    return DataLoader(
        items, size, shuffle=shuffle and not alone, sampler=sampler, collate_fn=collate, num_workers=workers,
        persistent_workers=workers > 0,
    )  # fmt: skip


def fit(
    network: nn.Module,
    terms: Terms,
    loaders: Sequence[DataLoader[Any]],
    schedule: Schedule,
    settings: Settings,
) -> dict[str, float]:
    """Train a network in place, on the first loader's batches; the second's are watched.

    Checkpoints, ``metrics.csv`` and, in ``tensorboard``, event files go to ``settings.logs``; an interrupted training
    goes on from its last checkpoint when it is called again with the same folder.
    A process that prepares examples beside has a core for itself.
    Same seed, same result on the same machine's processors; on a GPU some sums come in any order. With several
    processes only the first one returns: the others end when the training does.

    Returns
    -------
    dict
        The last values of all terms, named "train_..." and "val_...".
    """
    threads = torch.get_num_threads()
    torch.set_num_threads(max(1, threads - loaders[0].num_workers))  # else they wait for the one that prepares examples
    try:
        with tempfile.TemporaryDirectory() as folder:
            return _fit(network, terms, loaders, schedule, settings, settings.logs or Path(folder))
    finally:
        torch.set_num_threads(threads)


def _fit(
    network: nn.Module,
    terms: Terms,
    loaders: Sequence[DataLoader[Any]],
    schedule: Schedule,
    settings: Settings,
    folder: Path,
) -> dict[str, float]:
    seed, quiet, on_cpu = settings.seed, settings.quiet, accelerator_device(settings.accelerator).type == "cpu"
    logging.getLogger("pytorch_lightning").setLevel(logging.ERROR)
    warnings.filterwarnings("ignore", module="pytorch_lightning")
    lightning.seed_everything(seed, workers=True, verbose=False)
    best = ModelCheckpoint(folder, filename="best", monitor="val_loss", enable_version_counter=False)
    latest = ModelCheckpoint(folder, filename="last", enable_version_counter=False)
    losses = _BestLosses()
    extra: list[Callback] = [] if quiet else [_StepsBar()]
    if settings.patience is not None:
        extra.append(EarlyStopping("val_loss", patience=settings.patience))
    trainer = lightning.Trainer(
        max_epochs=settings.epochs,
        max_steps=schedule.steps,
        accelerator=settings.accelerator,
        devices=settings.devices,
        num_nodes=settings.nodes,
        deterministic=True if on_cpu else "warn",  # of some of torch's kernels a GPU has no other
        callbacks=[best, latest, losses, *extra],
        logger=[CSVLogger(folder, name="", version=""), TensorBoardLogger(folder, name="", version="tensorboard")],
        enable_progress_bar=False,
        enable_model_summary=False,
        num_sanity_val_steps=0,
        log_every_n_steps=1,
    )
    _keep_metrics(folder)
    last = folder / "last.ckpt"
    task = _Task(network, terms, schedule)
    if last.is_file():
        _load_checkpoint(last)  # Lightning would run what is in it
    try:
        trainer.fit(task, *loaders, ckpt_path=str(last) if last.is_file() else None)
    except SystemExit:
        if trainer.interrupted:
            raise KeyboardInterrupt from None
        raise
    if trainer.global_rank:
        raise SystemExit(0)
    if settings.patience is not None:
        state = _load_checkpoint(Path(best.best_model_path))["state_dict"]
        network.load_state_dict({name.removeprefix("network."): value for name, value in state.items()})
    network.cpu().eval()
    return losses.last


def _load_checkpoint(path: Path) -> dict[str, Any]:
    """The tensors and numbers of a checkpoint; UniSGError if there is anything else in it: that might run code."""
    try:
        found = torch.load(path, map_location="cpu", weights_only=True)
    except Exception as error:  # whatever a damaged file raises
        raise UniSGError(
            f"{path} is no checkpoint of a training ({type(error).__name__}): give another --logs, or remove the file"
        ) from None
    if not isinstance(found, dict) or not isinstance(found.get("state_dict"), dict):
        raise UniSGError(f"{path} is no checkpoint of a training: give another --logs, or remove the file")
    return found


def _keep_metrics(folder: Path) -> None:
    """Number the metrics of an earlier run, which the logger would replace."""
    before = folder / "metrics.csv"
    if before.is_file():
        before.rename(folder / f"metrics-{1 + len(list(folder.glob('metrics-*.csv')))}.csv")

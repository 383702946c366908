"""Train one network on one task with few rooms, and judge it twice: after as many steps as all, and as much time."""

from __future__ import annotations

import time
from collections.abc import Mapping
from copy import deepcopy
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor

from ...geometry.arrays import Ints
from ..hyperparameters import accelerator_device
from .room_arrays import RoomArrays
from .room_questions import TASKS, Question, error_of
from .room_tensors import RoomBatch, in_parts, room_batch
from .symmetry_networks import AUGMENTED, NETWORKS

BATCH, RATE, MEMORY = 4, 1e-2, 0.98
"""Rooms of a step, Adam's learning rate, and how much of the averaged weights stays in a step."""

EVERY, PATIENCE = 25, 8
"""Steps between looks at the held-out rooms, and looks without a better one after which it ends."""

HELD_OUT, MOST_HELD_OUT = 0.2, 40
"""Share of the rooms given that are not learned from but choose the weights, and how many at most."""

TESTED_AT_ONCE = 16


@lru_cache(maxsize=8)
def _rooms(path: Path) -> RoomArrays:
    return RoomArrays.load(path)


@cache
def width_for(network: str, task: str, parameters: int) -> int:
    """The even width with which a network and its head have the number of parameters nearest to the one asked for."""
    counts = {width: _count(_made(network, task, width)) for width in range(4, 65, 2)}
    return min(counts, key=lambda width: abs(counts[width] - parameters))


def _made(network: str, task: str, width: int) -> Question:
    return Question(NETWORKS[network](width), TASKS[task].per, TASKS[task].classes)


def _count(question: Question) -> int:
    return sum(weight.numel() for weight in question.parameters())


def split_rooms(rooms: RoomArrays, count: int, seed: int) -> tuple[Ints, Ints]:
    """Rooms to learn from and to choose the weights by, of each kind as equally as may be; ``count`` together."""
    rng = np.random.default_rng((seed, 27))
    orders = [rng.permutation(np.flatnonzero(rooms.kind == kind)) for kind in np.unique(rooms.kind)]
    turns = [(place / len(order), kind, room) for kind, order in enumerate(orders) for place, room in enumerate(order)]
    chosen = np.array([room for *_, room in sorted(turns)[:count]], np.int64)
    held_out = min(MOST_HELD_OUT, max(2, round(HELD_OUT * len(chosen))))
    return chosen[held_out:], chosen[:held_out]


def run(settings: Mapping[str, Any], data: Path) -> dict[str, Any]:
    """Errors in all test rooms, after equal steps and after equal time, with the weights that held-out rooms chose.

    ``settings``: task, network, rooms (how many are learned from, held-out ones among them), seed, parameters, steps,
    seconds (of processor time, or of the GPU's). ``data`` has what :func:`.compared_rooms.make_rooms` made.
    """
    task, asked, device = settings["task"], TASKS[settings["task"]], accelerator_device("auto")
    rooms = _rooms(data / f"{asked.rooms}-train.npz")
    learned, held_out = split_rooms(rooms, settings["rooms"], settings["seed"])
    width = width_for(settings["network"], task, settings["parameters"])
    torch.manual_seed(settings["seed"])
    question = _made(settings["network"], task, width).to(device)
    found = _fit(question, rooms, learned, held_out, settings, device)
    result: dict[str, Any] = {"parameters": _count(question), "width": width, "learned_from": len(learned)}
    sets = test_sets(data, task)
    for name, (state, step, seconds) in found.items():
        question.load_state_dict(state)
        result[name] = {"step": step, "seconds": round(seconds, 3)}
        result[name] |= {key: _judged(question, test, task, device) for key, test in sets.items()}
    return result


def test_sets(data: Path, task: str) -> dict[str, RoomArrays]:
    """Rooms to test on, by name: own and foreign ones, as they are and each turned about the vertical."""
    asked = TASKS[task]
    found: dict[str, RoomArrays] = {}
    for name in (asked.rooms, *(["foreign"] if asked.also_foreign else [])):
        if (data / f"{name}-test.npz").is_file():
            rooms = _rooms(data / f"{name}-test.npz")
            angles = np.random.default_rng(5).uniform(-np.pi, np.pi, len(rooms))
            found |= {name: rooms, f"{name}, turned": rooms.turned(angles)}
    return found


def _fit(
    question: Question, rooms: RoomArrays, learned: Ints, held_out: Ints, settings: Mapping[str, Any],
    device: torch.device,
) -> dict[str, tuple[dict[str, Tensor], int, float]]:  # fmt: skip
    """The best weights within ``steps`` steps, and within ``seconds``: by name, with when they were found."""
    task, rng = settings["task"], np.random.default_rng(settings["seed"])
    watched = room_batch(rooms.take(held_out), task, device)
    optimizer, averaged = torch.optim.Adam(question.parameters(), RATE), deepcopy(question)
    best, found, step, spent, looks = np.inf, {}, 0, 0.0, 0
    while looks < PATIENCE and (step < settings["steps"] or spent < settings["seconds"]):
        start = _now(device)
        for _ in range(EVERY):
            _step(question, averaged, optimizer, _drawn(rooms, learned, settings, rng, device), step)
            step += 1
        with torch.no_grad():
            loss = float(averaged.loss(watched, averaged(watched)))
        spent += _now(device) - start
        looks += 1
        if loss < best:
            best, looks = loss, 0
            state = {name: value.clone() for name, value in averaged.state_dict().items()}
            for name, limit, so_far in (("steps", settings["steps"], step), ("time", settings["seconds"], spent)):
                if so_far <= limit or name not in found:
                    found[name] = (state, step, spent)
    return found


def _step(question: Question, averaged: Question, optimizer: Any, batch: RoomBatch, step: int) -> None:
    loss = question.loss(batch, question(batch))
    optimizer.zero_grad()
    loss.backward()
    torch.nn.utils.clip_grad_norm_(question.parameters(), 1.0)
    optimizer.step()
    kept = min(MEMORY, step / (step + 10))
    with torch.no_grad():
        for old, new in zip(averaged.parameters(), question.parameters(), strict=True):
            old.lerp_(new, 1 - kept)


def _drawn(
    rooms: RoomArrays, learned: Ints, settings: Mapping[str, Any], rng: np.random.Generator, device: torch.device
) -> RoomBatch:
    some = rooms.take(rng.choice(learned, min(BATCH, len(learned)), replace=False))
    if settings["network"] in AUGMENTED:
        some = some.turned(rng.uniform(-np.pi, np.pi, len(some)))
    return room_batch(some, settings["task"], device, rng)


@torch.no_grad()
def _judged(question: Question, rooms: RoomArrays, task: str, device: torch.device) -> float:
    batches = [room_batch(rooms.take(part), task, device) for part in in_parts(len(rooms), TESTED_AT_ONCE)]
    answers = [question(batch) for batch in batches]
    per = TASKS[task].per
    if per == "pair":
        truth = torch.cat([batch.truth[batch.seen] for batch in batches])
        given = torch.cat([answer[batch.seen] for answer, batch in zip(answers, batches, strict=True)])
    else:
        truth, given = torch.cat([batch.truth for batch in batches]), torch.cat(answers)
    return round(error_of(per, given.cpu(), truth.cpu()), 5)


def _now(device: torch.device) -> float:
    """Processor seconds of this process; on an accelerator the clock, when all that was asked of it is done."""
    if device.type == "cpu":
        return time.process_time()
    torch.accelerator.synchronize(device)
    return time.perf_counter()

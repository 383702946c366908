"""The rooms of the comparison, made once: ours by seed, the same with things displaced, and rooms of others."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import numpy as np

from ...scene import SceneGraph
from ...worlds.world_batches import make_many
from .room_arrays import RoomArrays, joined, room_arrays

KINDS = ("operating-room", "living-room")

FIRST_TEST = 500_000
"""Seed of the first test room of each kind; training rooms have seeds from 0 on."""

FOREIGN_TESTS = 60
"""Rooms of others that none is trained on."""

Labelled = tuple[SceneGraph, int]


def make_rooms(
    folder: Path, train: int, test: int, foreign: Iterable[Labelled], jobs: int, progress: Callable[[str], None]
) -> None:
    """Write the files that are not there: own and moved rooms, and foreign ones if any are given.

    ``train`` and ``test`` count our rooms; ``foreign`` are rooms with the number of their kind.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for part, first, count in (("test", FIRST_TEST, test), ("train", 0, train)):
        if not (folder / f"own-{part}.npz").is_file():
            progress(f"{count} rooms to {part}")
            _write(folder, part, own_rooms(first, count, jobs))
    if not (folder / "foreign-test.npz").is_file() and len(rooms := list(foreign)) > FOREIGN_TESTS:
        order = np.random.default_rng(27).permutation(len(rooms))
        for part, rows in (("train", order[FOREIGN_TESTS:]), ("test", order[:FOREIGN_TESTS])):
            joined([room for row in rows if (room := room_arrays(*rooms[row]))]).save(folder / f"foreign-{part}.npz")


def own_rooms(first: int, count: int, jobs: int) -> Iterator[Labelled]:
    """Operating and living rooms in turn, each with its kind."""
    each = [make_many(kind, range(first, first + -(-count // len(KINDS))), jobs) for kind in KINDS]
    for together in zip(*each, strict=True):
        yield from zip(together, range(len(KINDS)), strict=True)


def _write(folder: Path, part: str, rooms: Iterable[Labelled]) -> None:
    own: list[RoomArrays] = []
    moved: list[RoomArrays] = []
    for number, (graph, kind) in enumerate(rooms):
        for found, rng in ((own, None), (moved, np.random.default_rng((number, len(part))))):
            if (room := room_arrays(graph, kind, rng)) is not None:
                found.append(room)
    joined(moved).save(folder / f"moved-{part}.npz")
    joined(own).save(folder / f"own-{part}.npz")

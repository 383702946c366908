"""Many scenes of a world, made in several processes."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from itertools import islice

from ..runtime.process_pool import process_pool
from ..scene.graph import SceneGraph

BATCH = 10


def make_scenes(name: str, seeds: Sequence[int]) -> list[SceneGraph]:
    """Scenes of a world, for a process of its own."""
    from . import WORLDS

    return [WORLDS[name](seed) for seed in seeds]


def make_many(name: str, seeds: Sequence[int], jobs: int) -> Iterator[SceneGraph]:
    """One scene of a world for each seed, in order; with one job they are made in this process."""
    batches = [seeds[start : start + BATCH] for start in range(0, len(seeds), BATCH)]
    jobs = min(jobs, len(batches))
    for scenes in _in_processes(name, batches, jobs) if jobs > 1 else _here(name, seeds):
        yield from scenes


def _here(name: str, seeds: Sequence[int]) -> Iterator[list[SceneGraph]]:
    for seed in seeds:
        yield make_scenes(name, [seed])


def _in_processes(name: str, batches: Sequence[Sequence[int]], jobs: int) -> Iterator[list[SceneGraph]]:
    """The batches in order; no more than a few are made ahead, so that memory stays small."""
    waiting = iter(batches)
    with process_pool(jobs) as pool:
        ahead = deque(pool.submit(make_scenes, name, batch) for batch in islice(waiting, 2 * jobs))
        while ahead:
            scenes = ahead.popleft().result()
            ahead.extend(pool.submit(make_scenes, name, batch) for batch in islice(waiting, 1))
            yield scenes

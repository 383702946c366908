"""Many scenes of a world, made in several processes."""

from __future__ import annotations

import pickle
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from itertools import islice

from ..runtime.process_pool import process_pool
from ..scene.graph import SceneGraph

BATCH = 10

World = Callable[[int], SceneGraph]


def make_scenes(world: World, seeds: Sequence[int]) -> list[SceneGraph]:
    """Scenes of a world, for a process of its own."""
    return [world(seed) for seed in seeds]


def make_many(name: str, seeds: Sequence[int], jobs: int) -> Iterator[SceneGraph]:
    """One scene of a world for each seed, in order.

    With one job they are made in this process, and so are those of a world of one's own that other processes
    could not import.
    """
    from . import WORLDS

    world = WORLDS[name]
    batches = [seeds[start : start + BATCH] for start in range(0, len(seeds), BATCH)]
    jobs = min(jobs, len(batches)) if can_be_imported(world) else 1
    for scenes in _in_processes(world, batches, jobs) if jobs > 1 else _here(world, seeds):
        yield from scenes


def can_be_imported(world: World) -> bool:
    """Whether other processes can find the function of a world."""
    try:
        pickle.dumps(world)
    except (pickle.PicklingError, AttributeError, TypeError):
        return False
    return getattr(world, "__module__", "__main__") != "__main__"


def _here(world: World, seeds: Sequence[int]) -> Iterator[list[SceneGraph]]:
    for seed in seeds:
        yield make_scenes(world, [seed])


def _in_processes(world: World, batches: Sequence[Sequence[int]], jobs: int) -> Iterator[list[SceneGraph]]:
    """The batches in order; no more than a few are made ahead, so that memory stays small."""
    waiting = iter(batches)
    with process_pool(jobs) as pool:
        ahead = deque(pool.submit(make_scenes, world, batch) for batch in islice(waiting, 2 * jobs))
        while ahead:
            scenes = ahead.popleft().result()
            ahead.extend(pool.submit(make_scenes, world, batch) for batch in islice(waiting, 1))
            yield scenes

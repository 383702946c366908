"""The scenes of the experiments, made once by code and kept as datasets: shards that all processes map."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from ...dataset import Sample, write_dataset
from ...meshes.shape_feature import AtlasNetEncoder
from ...scene import SceneGraph
from ...scene.augmentation import pose_noise, scale_noise
from ...worlds import WORLDS
from ...worlds.cube_world import cube_pairs, cubes
from ...worlds.world_batches import make_many

FORM = "trs_matrix"
"""The datasets hold whole affines; each experiment writes them in its own form."""

KINDS = ("operating-room", "living-room")
BASE_SEED, OTHER_SEEDS = 7, 200_000
NOISE = {"metres": 0.05, "radians": 0.1, "factor": 0.05}
STRONG = 4.0
TESTS = ("same noise", "unseen noise", "turned", "tumbled", "other rooms")
"""Sets of test scenes: as in training; noise 4 times as strong; the room turned about the vertical, or any way; other
rooms of the two worlds."""


@dataclass(frozen=True)
class Sizes:
    """How many scenes: of each kind in training and in each test, rooms to generate, pairs and sites of cubes.

    ``fields`` are the scenes of ``pairs`` pairs of cubes, one for each run.
    """

    augmented: int = 50
    tests: int = 25
    rooms: int = 1000
    pairs: int = 5000
    cubes: int = 60
    fields: int = 10


FULL = Sizes()
QUICK = Sizes(augmented=20, tests=8, rooms=60, pairs=300, cubes=16, fields=2)


def augmented(graph: SceneGraph, seed: int, strength: float = 1.0) -> SceneGraph:
    """The scene with noise on its poses and sizes; see :data:`NOISE`."""
    metres, radians, factor = (NOISE[name] * strength for name in ("metres", "radians", "factor"))
    return scale_noise(pose_noise(graph, seed, metres=metres, radians=radians), seed, factor=factor)


def tumbled(graph: SceneGraph, seed: int, upright: bool = False) -> SceneGraph:
    """The whole scene turned at random, about the vertical only if ``upright``."""
    rng = np.random.default_rng((seed, 21))
    turn = np.eye(4)
    angle = rng.uniform(-np.pi, np.pi)
    any_way = Rotation.random(random_state=int(rng.integers(2**31)))
    turn[:3, :3] = (Rotation.from_euler("z", angle) if upright else any_way).as_matrix()
    local = graph.local.copy()
    local[graph.parent < 0] = turn @ local[graph.parent < 0]
    return graph.replace(local=local)


def make_data(folder: Path, sizes: Sizes, jobs: int, progress: Callable[[str], None]) -> None:
    """Write the datasets that are not there yet."""
    folder.mkdir(parents=True, exist_ok=True)
    makers: dict[str, Callable[[], Iterable[Sample]]] = {
        "classification": lambda: _augmentations(sizes.augmented),
        "classification_tests": lambda: _tests(sizes.tests),
        "pairs_by_seed": lambda: (Sample(cube_pairs(seed, sizes.pairs)) for seed in range(sizes.fields)),
        **{f"cubes_{rotation}": partial(_cubes, sizes.cubes, rotation) for rotation in _ROTATIONS},
        "rooms": lambda: map(Sample, make_many("operating-room", range(sizes.rooms), jobs)),
    }
    encoder = AtlasNetEncoder()
    for name, maker in makers.items():
        if (folder / name).is_dir():
            continue
        progress(f"scenes: {name.replace('_', ' ')}")
        draft = folder / f".{name}"
        shutil.rmtree(draft, ignore_errors=True)
        write_dataset(maker(), draft, FORM, mesh_encoder=None if name == "rooms" else encoder)
        draft.rename(folder / name)


_ROTATIONS = ("yaw", "full")


def _cubes(count: int, rotation: str) -> Iterator[Sample]:
    return (Sample(cubes(seed, 40, rotation)) for seed in range(count))


def _augmentations(count: int) -> Iterator[Sample]:
    for kind in KINDS:
        base = WORLDS[kind](BASE_SEED)
        yield from (Sample(augmented(base, seed), f"{kind} {seed}", kind) for seed in range(count))


def _tests(count: int) -> Iterator[Sample]:
    """All of :data:`TESTS`; the source of a sample names its set."""
    for kind in KINDS:
        base = WORLDS[kind](BASE_SEED)
        for seed in range(10_000, 10_000 + count):
            room = augmented(base, seed)
            yield Sample(room, TESTS[0], kind)
            yield Sample(augmented(base, seed, STRONG), TESTS[1], kind)
            yield Sample(tumbled(room, seed, upright=True), TESTS[2], kind)
            yield Sample(tumbled(room, seed), TESTS[3], kind)
            yield Sample(augmented(WORLDS[kind](OTHER_SEEDS + seed), seed), TESTS[4], kind)

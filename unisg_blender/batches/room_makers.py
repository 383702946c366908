"""What makes the rooms of a batch; model and scene are loaded once in a process."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from ..formats.scene_files import read_scene_file
from ..generate import Generated, Generator, Sampling
from ..generate.variation.variation_file import variation_from
from ..generate.variation.varied_room import VariedRoom, known_variation, vary
from ..geometry.arrays import Ints
from ..runtime.serving_process import load_function
from ..scene import SceneBuilder, SceneGraph
from ..words import apply_mapping
from ..worlds import WORLDS
from .made_room import MadeRoom

GENERATED = "unisg_blender.batches.room_makers:generated_room"
WORLD = "unisg_blender.batches.room_makers:world_room"


def generated_room(settings: Mapping[str, Any], task: Mapping[str, Any]) -> MadeRoom:
    """The scene of a task with what a model adds to it, as ``unisg generate --seed`` makes it.

    ``settings``: ``model`` (path), ``add`` (counts or None for a whole room), ``variation`` (what varies, as in a file,
    or None), ``how`` (arguments of :meth:`~..generate.Generator.add`), ``mapping`` and ``assets`` (of reading scenes).
    """
    generator = _generator(settings["model"])
    scene = _scene(task["path"], task["sha256"], settings)
    how = settings["how"] | {"sampling": Sampling(**settings["how"].get("sampling", {}))}
    seed = task["seed"]
    base, label = Path(task["path"]) if task["path"] else None, Path(settings["model"]).stem
    if settings["variation"] is None:
        counts = settings["add"] or generator.sample_counts(np.random.default_rng(seed), scene, how["words"])
        result = generator.add(scene, counts, seed, **how)
        return MadeRoom(result.scene, added_record(result), label, base, result.rows)
    variation = known_variation(variation_from(settings["variation"]), generator, how["words"])
    made = vary(generator, scene, variation, seed, how, settings["add"])
    changed = {"removed": made.gone, "swapped": made.swapped, "moved": made.moved}
    record: dict[str, Any] = {name: len(uids) for name, uids in changed.items()} | {"redrawn": made.redrawn}
    if made.nothing:
        record["note"] = f"nothing is called {' or '.join(map(repr, made.nothing))}"
    return MadeRoom(
        made.scene, added_record(made.generated) | record, label, base, new_rows(scene, made), lost_uids(scene, made),
        made.moved, changed=True,
    )  # fmt: skip


def new_rows(scene: SceneGraph, made: VariedRoom) -> Ints:
    """Rows of a variation that its scene has not, or that have another shape in it."""
    known = set(scene.uid) - set(made.swapped)
    return np.array([row for row, uid in enumerate(made.scene.uid) if uid not in known], np.int64)


def lost_uids(scene: SceneGraph, made: VariedRoom) -> tuple[str, ...]:
    """uids of a scene that a variation has not, or that have another shape in it."""
    kept = set(made.scene.uid) - set(made.swapped)
    return tuple(uid for uid in scene.uid if uid not in kept)


def added_record(result: Generated) -> dict[str, Any]:
    """What a report says of what was added: how many, and how many of which category found no place."""
    refused = Counter(item.category for item in result.refused)
    return {"added": result.added, "actions": result.actions, "refused": dict(sorted(refused.items()))}


def world_room(settings: Mapping[str, Any], task: Mapping[str, Any]) -> MadeRoom:
    """The scene of a world for the seed of a task; ``settings``: ``world`` (its name), ``function`` (where it is)."""
    name = settings["world"]
    make = load_function(settings["function"]) if settings["function"] else WORLDS[name]
    scene = make(task["seed"])
    return MadeRoom(scene, {"source": scene.title}, name)


@lru_cache(maxsize=2)
def _generator(model: str) -> Generator:
    return Generator.load(model)


def _scene(path: str, sha256: str, settings: Mapping[str, Any]) -> SceneGraph:
    """The scene of a file with the categories of a mapping, read once as long as it stays the same; "" for none."""
    if not path:
        return SceneBuilder("Room").build()
    scene = _read(path, sha256, settings["assets"])
    return scene if settings["mapping"] is None else apply_mapping(scene, settings["mapping"])


@lru_cache(maxsize=4)
def _read(path: str, sha256: str, assets: str) -> SceneGraph:
    return read_scene_file(path, assets=Path(assets) if assets else None)[0]

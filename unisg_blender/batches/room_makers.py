"""What makes the rooms of a batch; model and scene are loaded once in a process."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from ..formats.scene_files import read_scene_file
from ..generate import Generated, Generator
from ..runtime.serving_process import load_function
from ..scene import SceneBuilder, SceneGraph
from ..words import apply_mapping
from ..worlds import WORLDS
from .made_room import MadeRoom

GENERATED = "unisg_blender.batches.room_makers:generated_room"
WORLD = "unisg_blender.batches.room_makers:world_room"


def generated_room(settings: Mapping[str, Any], task: Mapping[str, Any]) -> MadeRoom:
    """The scene of a task with what a model adds to it, as ``unisg generate --seed`` makes it.

    ``settings``: ``model`` (path), ``add`` (counts or None for a whole room), ``how`` (arguments of
    :meth:`~..generate.Generator.add`), ``mapping`` and ``assets`` (of reading scenes).
    """
    generator = _generator(settings["model"])
    scene = _scene(task["path"], task["sha256"], settings)
    seed, how = task["seed"], settings["how"]
    counts = settings["add"] or generator.sample_counts(np.random.default_rng(seed), scene, how["words"])
    result = generator.add(scene, counts, seed, **how)
    base = Path(task["path"]) if task["path"] else None
    return MadeRoom(result.scene, added_record(result), Path(settings["model"]).stem, base, result.rows)


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

"""A quick reader for the tests of exports: small JSON files stand for scene files, bad ones included."""

from __future__ import annotations

import ctypes
import json
import os
import time
from pathlib import Path

import numpy as np

from unisg_blender.scene import SceneBuilder, SceneGraph, mesh_from_faces

TRIANGLE = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


def read(path: Path) -> tuple[list[SceneGraph], str, list[Path]]:
    """The scenes that a file asks for, after whatever trouble it asks for."""
    order = json.loads(path.read_text())
    time.sleep(order.get("seconds", 0))
    trouble = order.get("trouble", "")
    if trouble == "crash":
        ctypes.string_at(0)
    elif trouble == "exit":
        os._exit(7)
    elif trouble == "memory":
        np.ones(2**36).sum()
    elif trouble == "bug":
        raise ZeroDivisionError("in the reader")
    seed = order["seed"]
    scenes = [scene(seed, number) for number in range(order.get("scenes", 1))]
    return scenes, order.get("note", ""), [path.parent / name for name in order.get("beside", ())]


def scene(seed: int, number: int) -> SceneGraph:
    """A table with some tools on it."""
    rng = np.random.default_rng([seed, number])
    builder = SceneBuilder(title=f"{seed}-{number}")
    mesh = mesh_from_faces(f"mesh {seed % 3}", TRIANGLE * (1 + seed % 3), [[0, 1, 2]])
    table = builder.add("Table", uid=f"{seed}-{number}-t", mesh=mesh, category="Table")
    for tool in range(1 + seed % 4):
        local = np.eye(4)
        local[:3] = rng.normal(size=(3, 4))
        category = f"Tool {rng.integers(5)}"
        builder.add(f"Tool.{tool}", uid=f"{seed}-{number}-{tool}", parent=table, local=local, category=category)
    return builder.build()


def encode(mesh: object) -> np.ndarray:
    """A mesh encoder."""
    return np.full(4, len(mesh.points), np.float32)  # type: ignore[attr-defined]

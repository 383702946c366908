"""Rooms that others designed, as scenegraphs of boxes, with what they say stands on what.

Three public sources, all made in Unity (left-handed, y up, metres):

- iTHOR ``objects.json``: per floor plan objects with oriented boxes and their receptacles;
- VirtualHome ``*_graph.json``: nodes with axis-aligned boxes, and edges ON and INSIDE;
- ThreeDWorld ``floorplan_layouts.json`` with ``models_core.json``: poses and bounds, no support.

A point (x, y, z) of theirs is (x, z, y) here. Every object is one box: their meshes are not public.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from ...errors import UniSGError
from ...scene import SceneBuilder, SceneGraph, mesh_from_faces

FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
THINNEST = 1e-3
SHELL = ("ceiling", "wall", "walls")

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DesignedRoom:
    """A room: ``supports`` are pairs (row, row of what it stands on), None where the source says nothing; ``unclear``
    pairs are told in another way (a book inside a bookshelf) and count neither for nor against a prediction."""

    name: str
    graph: SceneGraph
    supports: frozenset[tuple[int, int]] | None
    unclear: frozenset[tuple[int, int]] = frozenset()


@dataclass(frozen=True, eq=False)
class _Box:
    """An object: the ``key`` by which the source refers to it, the pose (4, 4) of its bottom's middle, and its size."""

    key: str
    category: str
    pose: Array
    size: Array


def read_layouts(folder: Path) -> list[DesignedRoom]:
    """All rooms of a folder with the sub-folders ``ithor``, ``virtualhome`` and ``tdw``, as far as they are there.

    Raises
    ------
    UniSGError
        If a file cannot be read, or there is none.
    """
    rooms = []
    for path in sorted(folder.glob("ithor/objects.json")):
        rooms += list(_ithor(_load(path)))
    for path in sorted(folder.glob("virtualhome/*_graph.json")):
        rooms.append(_virtualhome(path.stem.removesuffix("_graph"), _load(path)))
    for path in sorted(folder.glob("tdw/floorplan_layouts.json")):
        rooms += list(_tdw(_load(path), _load(path.with_name("models_core.json"))["records"]))
    if not rooms:
        raise UniSGError(f"{folder} has no layouts: give a folder with ithor/, virtualhome/ or tdw/ in it")
    return rooms


def _load(path: Path) -> Any:
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UniSGError(f"cannot read {path}: {error}") from None


def _room(
    name: str, boxes: list[_Box], pairs: set[tuple[str, str]] | None, unclear: set[tuple[str, str]]
) -> DesignedRoom:
    builder = SceneBuilder(name)
    counts: dict[str, int] = {}
    for box in boxes:
        counts[box.category] = number = counts.get(box.category, -1) + 1
        label = f"{box.category}.{number:03d}" if number else box.category
        x, y, z = np.maximum(box.size, THINNEST)
        corners = np.stack(np.meshgrid([-x / 2, x / 2], [-y / 2, y / 2], [0, z], indexing="ij"), axis=-1)
        mesh = mesh_from_faces(label, corners.reshape(-1, 3), FACES)
        builder.add(label, uid=box.key, local=box.pose, mesh=mesh, category=box.category)
    graph = builder.build()
    rows = graph.row_of_uid

    def known(found: set[tuple[str, str]]) -> frozenset[tuple[int, int]]:
        """Pairs of rows by pairs of names, of those that are there."""
        return frozenset((rows[a], rows[b]) for a, b in found if a in rows and b in rows and a != b)

    return DesignedRoom(name, graph, None if pairs is None else known(pairs), known(unclear))


def _point(record: Mapping[str, float]) -> Array:
    return np.array([record["x"], record["z"], record["y"]], np.float64)


def _upright(low: Array, high: Array) -> tuple[Array, Array]:
    """Pose and size of an axis-aligned box."""
    pose = np.eye(4)
    pose[:3, 3] = (low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]
    return pose, high - low


def _ithor(plans: Mapping[str, list[dict[str, Any]]]) -> Iterator[DesignedRoom]:
    for plan, objects in plans.items():
        boxes, pairs = [], set[tuple[str, str]]()
        for item in objects:
            bounds = item["objectOrientedBoundingBox"] or item["axisAlignedBoundingBox"]
            corners = np.array(bounds["cornerPoints"], np.float64).reshape(-1, 3)[:, [0, 2, 1]]
            if not len(corners) or not np.isfinite(corners).all():
                continue
            oriented = item["objectOrientedBoundingBox"] is not None
            pose, size = _oriented(corners) if oriented else _upright(corners.min(axis=0), corners.max(axis=0))
            boxes.append(_Box(item["objectId"], _words(item["objectType"]), pose, size))
            pairs |= {(item["objectId"], above) for above in item["parentReceptacles"] or ()}
        yield _room(f"iTHOR {plan}", boxes, pairs, set())


def _oriented(corners: Array) -> tuple[Array, Array]:
    """Pose and size of an oriented box by its corners: the bottom ring, then the top one."""
    edges = corners[[1, 3, 4]] - corners[0]
    size = np.linalg.norm(edges, axis=1)
    if (size < THINNEST).any():
        return _upright(corners.min(axis=0), corners.max(axis=0))
    axes = (edges / size[:, None]).T
    if np.linalg.det(axes) < 0:
        axes[:, 0] *= -1
    pose = np.eye(4)
    pose[:3, :3] = axes
    pose[:3, 3] = corners.mean(axis=0) - axes[:, 2] * size[2] / 2
    return pose, size


def _virtualhome(name: str, record: Mapping[str, Any]) -> DesignedRoom:
    nodes = {node["id"]: node for node in record["nodes"] if node["category"] not in ("Rooms", "Characters")}
    boxes = []
    for node in nodes.values():
        center, size = (np.array(node["bounding_box"][key], np.float64)[[0, 2, 1]] for key in ("center", "size"))
        boxes.append(_Box(str(node["id"]), node["class_name"], *_upright(center - size / 2, center + size / 2)))
    told: dict[str, set[tuple[str, str]]] = {"ON": set(), "INSIDE": set()}
    for edge in record["edges"]:
        ends = edge["from_id"], edge["to_id"]
        if edge["relation_type"] not in told or not all(end in nodes for end in ends):
            continue
        if not any(nodes[end]["class_name"] in SHELL for end in ends):
            told[edge["relation_type"]].add((str(ends[0]), str(ends[1])))
    return _room(f"VirtualHome {name}", boxes, told["ON"], told["INSIDE"] - told["ON"])


def _tdw(plans: Mapping[str, Mapping[str, Any]], models: Mapping[str, Any]) -> Iterator[DesignedRoom]:
    for plan, layouts in plans.items():
        for layout, objects in layouts.items():
            boxes = []
            for number, item in enumerate(objects):
                model = models.get(item["name"])
                if model is None:
                    continue
                sides = [_point(model["bounds"][side]) for side in ("left", "right", "front", "back", "bottom", "top")]
                scale = _point(item["scale_factor"])
                size = (np.max(sides, axis=0) - np.min(sides, axis=0)) * scale
                pose = np.eye(4)
                pose[:3, :3] = turn_of(item["rotation"])
                pose[:3, 3] = _point(item["position"])
                boxes.append(_Box(str(number), model["wcategory"] or item["name"], pose, size))
            yield _room(f"TDW {plan}-{layout}", boxes, None, set())


def turn_of(degrees: Mapping[str, float]) -> Array:
    """The rotation (3, 3) of Unity's Euler angles, R = Ry Rx Rz, seen in our axes."""
    swap = np.eye(3)[[0, 2, 1]]
    turn: Array = swap @ Rotation.from_euler("YXZ", [degrees[axis] for axis in "yxz"], degrees=True).as_matrix() @ swap
    return turn


def _words(name: str) -> str:
    """ "CoffeeTable" as "Coffee Table"; "TVStand" as "TV Stand"."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", " ", name)

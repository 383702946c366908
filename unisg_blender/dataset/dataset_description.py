"""A dataset in numbers and words: what ``unisg inspect DATASET`` prints."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from ..formats.licences import forbids_shipping
from ..runtime.wording import first_lines
from .format.columns import Columns
from .format.reader import Dataset, open_dataset

SHOWN = 40


def describe_dataset(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Counts of everything in a dataset, JSON-ready; reads the sizes of all scenes, not their contents.

    Raises
    ------
    UniSGError
        If there is no dataset, or one of its files is damaged.
    """
    dataset = open_dataset(path)
    manifest = dataset.manifest
    names = dataset.vocabulary
    totals = {key: np.zeros(len(names[kind]) + 1, np.int64) for key, kind in COUNTED.items()}
    sizes = []
    for number in range(len(manifest["shards"])):
        columns = dataset.shard(number)
        sizes.append(np.diff(columns["entity.ptr"]))
        for key, total in totals.items():
            total += np.bincount(columns[key] + 1, minlength=len(total))
    files = dataset.files()
    entities = np.concatenate(sizes)
    return {
        "dataset": str(path),
        "software": manifest["software"],
        "form": dataset.form,
        "features": len(manifest["feature_channels"]),
        "mesh_feature_width": manifest["mesh_feature_width"],
        "bytes": sum((dataset.path / shard["file"]).stat().st_size for shard in manifest["shards"]),
        "shapes": _shapes(dataset),
        "shards": len(manifest["shards"]),
        "counts": manifest["counts"],
        "entities_per_scene": dict(zip(("least", "median", "most"), _spread(entities), strict=True)),
        "categories": _ranked(names["categories"], totals["entity.category"]),
        "uncategorised": int(totals["entity.category"][0]),
        "relations": _ranked(names["relations"], totals["relation.kind"]),
        "scenes": _ranked(names["scenes"], totals["scene.label"]),
        "files": len(files),
        "sources": manifest.get("sources", []),
        "failures": [{key: file[key] for key in ("source", "reason")} for file in files if file["status"] == "failed"],
    }


def _shapes(dataset: Dataset) -> dict[str, int]:
    """How many objects, of how many categories, and how many rooms the dataset keeps with their geometry."""
    file = dataset.assets()
    kinds = [record["category"] for record in file.index["assets"]] if file is not None else []
    return {
        "things": len(kinds) - kinds.count(""),
        "categories": len(set(kinds) - {""}),
        "rooms": kinds.count(""),
    }


COUNTED = {"entity.category": "categories", "relation.kind": "relations", "scene.label": "scenes"}


def _spread(values: np.ndarray) -> tuple[int, float, int]:
    return int(values.min()), float(np.median(values)), int(values.max())


def _ranked(names: tuple[str, ...], totals: np.ndarray) -> dict[str, int]:
    """Counts by name, most frequent first; the first total is that of objects without a name."""
    order = np.argsort(-totals[1:], kind="stable")
    return {names[place]: int(totals[place + 1]) for place in order}


def description_lines(record: dict[str, Any]) -> list[str]:
    """The record of :func:`describe_dataset` for people."""
    counts, spread = record["counts"], record["entities_per_scene"]
    size = f"{record['bytes'] / 2**20:.1f} MiB in {record['shards']} shards"
    lines = [
        f"{record['dataset']}: {counts['scenes']} scenes, {counts['entity']} entities, {size}",
        f"written by {record['software']}; poses as {record['form']} ({record['features']} features with stretch)",
        f"entities per scene: {spread['least']} to {spread['most']}, median {spread['median']:g}",
        "rows: " + ", ".join(f"{name} {count}" for name, count in counts.items() if name not in ("scenes", "entity")),
    ]
    for kind in ("categories", "relations", "scenes"):
        if record[kind]:
            title = "kinds of scene" if kind == "scenes" else kind
            lines += [f"{title}:", *_table(record[kind])]
    lines.append(f"entities without a category: {record['uncategorised']}")
    shapes = record["shapes"]
    lines.append(f"shapes: {shapes['things']} things of {shapes['categories']} categories, {shapes['rooms']} rooms")
    if record["files"]:
        lines.append(f"read from {record['files']} files, {len(record['failures'])} of them in vain")
    lines += [f"  {source_line(entry)}" for entry in record["sources"] if entry["format"] or entry["licence"]]
    failures = [f"  {printable(failure['source'])}: {failure['reason']}" for failure in record["failures"]]
    return lines + first_lines(failures, SHOWN, "more (--json has them)")


def source_line(entry: dict[str, Any]) -> str:
    """What a dataset has of one kind of file under one licence, and what that forbids."""
    kind, licence = printable(entry["format"]) or "scene files", printable(entry["licence"]) or "licence unknown"
    told = "; a model trained on it is not to be shipped or sold" if forbids_shipping(licence) else ""
    return f"{entry['scenes']} scenes from {entry['files']} files, {kind}, {licence}{told}"


def printable(path: str) -> str:
    """A path for a line of text: names of files may hold line breaks and bytes that are no Unicode."""
    return "".join(sign if sign.isprintable() else sign.encode("unicode_escape").decode() for sign in path)


def _table(counts: dict[str, int]) -> list[str]:
    width = max(map(len, counts))
    most = max(max(counts.values()), 1)
    lines = [
        f"  {name:<{width}} {count:>9} {'#' * round(30 * count / most)}".rstrip() for name, count in counts.items()
    ]
    return first_lines(lines, SHOWN, "more")


def scene_numbers(dataset: Dataset, count: int) -> list[int]:
    """Up to ``count`` scenes spread evenly over a dataset."""
    return np.unique(np.linspace(0, len(dataset) - 1, min(count, len(dataset))).round().astype(int)).tolist()


def entity_sizes(columns: Columns) -> np.ndarray:
    """Longest side, float32 (K,) metres in their own frames, of the entities with a mesh."""
    bounds = columns["entity.bounds"][columns["entity.mesh"] >= 0]
    return (bounds[:, 1] - bounds[:, 0]).max(axis=1, initial=0)

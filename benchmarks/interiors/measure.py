"""Structure of interiors that others made, against what was marked by eye: floors found, outlines, rooms, surfaces.

    python benchmarks/interiors/measure.py FOLDER [--all | --held-out] [--only NAME ...] [--out FILE.json]

FOLDER holds the repositories that interiors.json names, each as owner+name; `--fetch` clones those that are missing, at
their commits. IFC files need ifcopenshell; what cannot be read is said, and counts as not found.
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from unisg_blender.errors import UniSGError
from unisg_blender.experiments.reports import made_by, markdown_table, write_json
from unisg_blender.formats import read_scene_file
from unisg_blender.formats.asset_folder import AssetFolder
from unisg_blender.formats.layout_scenes import layout_scenes
from unisg_blender.geometry.polygon import inside
from unisg_blender.scene import SceneGraph
from unisg_blender.spatial.structure import HoldingSurface, Room, recognise_structure

TRUTH = Path(__file__).parent / "interiors.json"

SAME_FLOOR, WALL, FOUND = 0.3, 0.35, 0.5
"""Metres between heights of one floor; half the thickness of walls that part rooms of one outline; and the intersection
over union from which on a floor counts as found."""

SAME_SURFACE, MOST = 0.03, 0.5
"""Metres of height within which surfaces are one, and the share of one that others cover."""

CELL, LARGE = 0.05, 80.0
"""Metres of a cell in which outlines are compared; and of a building that is compared twice as coarsely."""


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--held-out", action="store_true", help="those that nothing was chosen on")
    which.add_argument("--all", action="store_true", help="these and those that choices were made on")
    parser.add_argument("--only", nargs="+", default=[], help="names of interiors")
    parser.add_argument("--fetch", action="store_true", help="clone missing repositories")
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    truth = json.loads(TRUTH.read_text("utf8"))
    rows = []
    for entry in truth["interiors"]:
        if entry["name"] in args.only or (not args.only and (args.all or entry["held_out"] == args.held_out)):
            if args.fetch:
                fetch(args.folder, entry["source"], truth["sources"][entry["source"]]["commit"])
            rows += measured(entry, args.folder)
    report(rows, args.out)


def fetch(folder: Path, source: str, commit: str) -> None:
    """Clone a repository, if it is missing, and check its commit out."""
    target = folder / source.replace("/", "+")
    if not target.exists():
        subprocess.run(["git", "clone", "--filter=blob:none", f"https://github.com/{source}", str(target)], check=True)
        subprocess.run(["git", "-C", str(target), "checkout", commit], check=True)


def read(entry: dict[str, Any], folder: Path) -> SceneGraph:
    """The scene of an interior, in metres, z up."""
    root = folder / entry["source"].replace("/", "+")
    path = root / entry["path"]
    if path.suffix == ".ifc":
        from building_models import read_building

        return read_building(path)
    if path.suffix in (".world", ".sdf", ".urdf"):
        places = AssetFolder(root, (path.parent, path.parent.parent, folder / "osrf+gazebo_models"))
        return next(layout_scenes(path, places)).graph
    return read_scene_file(path)[0]


def measured(entry: dict[str, Any], folder: Path) -> list[dict[str, Any]]:
    """A record for each storey; of a file that cannot be read, with nothing found."""
    said = {key: entry[key] for key in ("name", "source", "held_out")}
    try:
        graph = read(entry, folder)
    except (ImportError, OSError, UniSGError) as problem:
        print(f"{entry['name']}: {problem}", file=sys.stderr)
        return [
            said | {"floor": storey["floor"], "iou": 0.0, "rooms": 0, "objects": 0, "seconds": 0.0}
            for storey in entry["storeys"]
        ]
    start = time.perf_counter()
    structure = recognise_structure(graph)
    seconds = time.perf_counter() - start
    indoors = [room for room in structure.rooms if room.indoors]
    rows = []
    for storey in entry["storeys"]:
        share, count = outline_overlap(indoors, storey)
        row = said | {"floor": storey["floor"], "iou": round(share, 3)}
        row |= {"rooms": count, "objects": len(graph), "seconds": round(seconds, 3)}
        if "surfaces" in entry and storey is entry["storeys"][0]:
            here = [top for top in structure.surfaces if structure.rooms[top.room] in _near(indoors, storey)]
            row |= dict(zip(("right", "wrong", "missed"), surface_counts(here, entry), strict=True))
            row["marked"] = len(entry["surfaces"])
        rows.append(row)
        print(json.dumps(row), flush=True)
    return rows


def _near(rooms: list[Room], storey: dict[str, Any]) -> list[Room]:
    return [room for room in rooms if abs(room.floor - storey["floor"]) <= SAME_FLOOR]


def outline_overlap(rooms: list[Room], storey: dict[str, Any]) -> tuple[float, int]:
    """Intersection over union of the rooms of a storey and what was marked, walls closed; how many rooms."""
    from scipy.ndimage import binary_closing

    marked = [np.array(polygon) for polygon in storey["outline"]]
    near = _near(rooms, storey)
    corners = np.concatenate([*marked, *(room.outline for room in near)])
    low, size = corners.min(axis=0) - 1, np.ptp(corners, axis=0) + 2
    cell = CELL if size.max() < LARGE else 2 * CELL
    reach = round(WALL / cell)
    disc = np.hypot(*np.mgrid[-reach : reach + 1, -reach : reach + 1]) <= reach
    axes = [low[k] + (np.arange(int(size[k] / cell) + 1) + 0.5) * cell for k in (0, 1)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)

    def covered(polygons: list[Any]) -> Any:
        found = np.zeros(points.shape[:2], bool)
        for polygon in polygons:
            found |= _within(np.asarray(polygon), points, low, cell)
        return found

    one = binary_closing(covered(marked), disc)
    two = np.zeros(one.shape, bool)
    for room in near:
        two |= covered([room.outline]) & ~covered(list(room.holes))
    two = binary_closing(two, disc)
    clear = ~covered(storey["unclear"])
    return float((one & two & clear).sum() / max(((one | two) & clear).sum(), 1)), len(near)


def _within(polygon: Any, points: Any, low: Any, cell: float) -> Any:
    """Which cells of a grid are in a polygon, looked at around it only."""
    found = np.zeros(points.shape[:2], bool)
    first = np.maximum(((polygon.min(axis=0) - low) / cell).astype(int) - 1, 0)
    last = ((polygon.max(axis=0) - low) / cell).astype(int) + 2
    part = slice(first[0], last[0]), slice(first[1], last[1])
    window = points[part]
    found[part] = inside(polygon, window.reshape(-1, 2)).reshape(window.shape[:2])
    return found


def surface_counts(found: list[HoldingSurface], entry: dict[str, Any]) -> tuple[int, int, int]:
    """How many surfaces are right, wrong and missed.

    A surface that was found is right if most of it is on marked ones at its height, together: one may see a seat where
    another sees three cushions. A marked one is missed unless most of it is covered by what was found. Those marked as
    unclear count as neither.
    """
    boxes = [np.array([top.height, *top.outline.min(axis=0), *top.outline.max(axis=0)]) for top in found]
    marked, unclear = ([np.array(box) for box in entry[key]] for key in ("surfaces", "unclear_surfaces"))
    on_marked = [_covered(box, marked) for box in boxes]
    on_unclear = [_covered(box, unclear) for box in boxes]
    right = sum(share >= MOST for share in on_marked)
    wrong = sum(share < MOST and other < MOST for share, other in zip(on_marked, on_unclear, strict=True))
    return right, wrong, sum(_covered(box, boxes) < MOST for box in marked)


def _covered(box: Any, others: list[Any]) -> float:
    """The share of a surface (height, x and y of two corners) that is on others at its height."""
    steps = (np.arange(24) + 0.5) / 24
    points = box[1:3] + np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2) * (box[3:] - box[1:3])
    found = np.zeros(len(points), bool)
    for other in others:
        if abs(other[0] - box[0]) <= SAME_SURFACE:
            found |= ((points >= other[1:3]) & (points <= other[3:])).all(axis=1)
    return float(found.mean())


def f1(right: int, wrong: int, marked: int, missed: int) -> float:
    """The harmonic mean of the shares of surfaces found that are right, and of those marked that are found."""
    precision, recall = right / max(right + wrong, 1), (marked - missed) / max(marked, 1)
    return 2 * precision * recall / max(precision + recall, 1e-9)


def report(rows: list[dict[str, Any]], out: Path | None) -> None:
    """Print a table, and write the record: totals of those chosen on, those held out and all, and every storey."""
    parts = {"dev": [row for row in rows if not row["held_out"]], "held_out": [row for row in rows if row["held_out"]]}
    record: dict[str, Any] = {name: {"totals": totals(some), "rows": some} for name, some in parts.items() if some}
    if len(record) > 1:
        record["all"] = {"totals": totals(rows)}
    lines = [[name, *map(str, part["totals"].values())] for name, part in record.items()]
    print(markdown_table(["part", *totals(rows)], lines))
    if out is not None:
        known = json.loads(out.read_text("utf8")) if out.is_file() else {}
        write_json(out, known | made_by() | record)


def totals(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """What counts of some storeys together."""
    shares = [row["iou"] for row in rows]
    right, wrong, marked, missed = (
        sum(row.get(key, 0) for row in rows) for key in ("right", "wrong", "marked", "missed")
    )  # fmt: skip
    return {
        "storeys": len(rows), "interiors": len({row["name"] for row in rows}),
        "found": round(float(np.mean([share >= FOUND for share in shares])), 3),
        "median_iou": round(statistics.median(shares), 3), "mean_iou": round(float(np.mean(shares)), 3),
        "least_iou": min(shares), "surfaces": marked,
        "surface_f1": round(f1(right, wrong, marked, missed), 3) if marked else None,
        "median_seconds": round(statistics.median(row["seconds"] for row in rows), 2),
    }  # fmt: skip


if __name__ == "__main__":
    main()

"""Scenes that others made, there and back: what Blender or USD show of a file, before and after it went through.

    python benchmarks/round_trip.py SCENES --count 50 --seed 1 --results docs/results/round_trip.csv

SCENES holds a folder for each repository. Files are drawn by seed, their kinds and repositories in turn, those without
any visible mesh left out. Each goes by ``unisg convert`` to USD and from there to a Blender file, both of which end in
the same scenegraph; points, bounds and what moves are compared with what is seen of the file without this library.
"""

from __future__ import annotations

import argparse
import csv
import json
import random
import subprocess
import sys
import tempfile
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
KINDS = (".blend", ".glb", ".gltf", ".fbx", ".obj", ".usd", ".usda", ".usdc", ".usdz")
SECONDS = 300
CLOSE = 1e-3
"""Of the scene's size: single precision, turned and scaled a few times."""
ROUND = 2e-2
"""Where spheres and the like are approximated by faces."""
SAME_GRAPH = """
import os, sys
from tests.usd.compare import assert_same_graph
from unisg_blender.formats.scene_files import load_blender, read_scene_file, write_scene_file
load_blender()
graph, _ = read_scene_file(sys.argv[1], animation=True)
write_scene_file(graph, sys.argv[2])
assert_same_graph(graph, read_scene_file(sys.argv[2])[0])
sys.stdout.flush()
os._exit(0)
"""


def drawn(folder: Path, left_out: set[str], seed: int) -> Iterator[Path]:
    """All scene files in an order by chance: the kinds in turn, in each kind the repositories in turn."""
    groups: dict[str, dict[str, list[Path]]] = defaultdict(lambda: defaultdict(list))
    for path in sorted(folder.rglob("*")):
        if path.suffix.lower() in KINDS and path.name not in left_out and path.is_file():
            groups[path.suffix.lower()][path.relative_to(folder).parts[0]].append(path)
    chance = random.Random(seed)
    orders = [_in_turn([chance.sample(files, len(files)) for files in kind.values()]) for kind in groups.values()]
    yield from _in_turn(orders)


def _in_turn(lists: list[list[Path]]) -> list[Path]:
    longest = max(map(len, lists), default=0)
    return [files[place] for place in range(longest) for files in lists if place < len(files)]


def run(*words: object) -> subprocess.CompletedProcess[str]:
    """A process of this Python in the checkout."""
    command = [sys.executable, *map(str, words)]
    return subprocess.run(
        command, cwd=ROOT, capture_output=True, text=True, errors="replace", timeout=SECONDS, check=False
    )


def seen(path: Path, *frames: float) -> dict[str, Any]:
    """What is seen of a file without this library; empty if that fails."""
    done = run("benchmarks/seen_geometry.py", path, *frames)
    lines = [line for line in done.stdout.splitlines() if line.startswith('{"frame"')]
    return json.loads(lines[-1]) if lines else {}


def tried(path: Path, folder: Path) -> tuple[str, int, int]:
    """What came of a file ("same", or what differs), how many points are seen of it, how many losses were told."""
    through, back = folder / "through.usdc", folder / "back.blend"
    for source, target in ((path, through), (through, back)):
        done = run("-m", "unisg_blender", "convert", source, target, "--json", "-q")
        if done.returncode:
            points = seen(path).get("points", 0)
            return f"{target.name}: {done.stderr.strip()[-200:]}" if points else "unseen", points, 0
        if target is through:
            told = len(json.loads(done.stdout)["not_represented"])
    after = seen(back)
    timed = path.suffix.lower() == ".blend" or path.suffix.lower().startswith(".usd")
    before = seen(path, *(() if timed else (after["frame"], after["last"])))
    graphs = run("-c", SAME_GRAPH, path, folder / "again.usdc")
    if graphs.returncode:
        return f"graph: {graphs.stderr.strip().splitlines()[-1][:200]}", before.get("points", 0), told
    return difference(before, after), before.get("points", 0), told


def difference(before: dict[str, Any], after: dict[str, Any]) -> str:
    """In words what is not the same, or "same"."""
    if not before:
        return "unseen"
    if not before["points"]:
        return "empty"
    for key in ("frame", "last", "meshes", "points"):
        free = (before["shapes"] and key == "points") or before[key] is None
        if not free and not np.isclose(before[key], after[key], rtol=1e-9):
            return f"{key}: {before[key]} before, {after[key]} after"
    size = max(np.subtract(before["high"], before["low"]).max(), np.abs([before["low"], before["high"]]).max() * CLOSE)
    for key in ("low", "high", "mean", "origins"):
        if before["shapes"] and key == "mean":
            continue
        apart = float(np.abs(np.subtract(before[key], after.get(key, np.nan))).max()) / size
        if not apart <= (ROUND if before["shapes"] else CLOSE):
            return f"{key}: {apart:.2%} of the size apart"
    return "same"


def main() -> int:
    """Try the files; returns how many did not come back."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", type=Path, help="a folder of repositories")
    parser.add_argument("--count", type=int, default=50, help="scenes to try (50)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--seen-before", type=Path, nargs="*", default=[], help="folders whose files are left out, by name"
    )
    parser.add_argument("--results", type=Path, help="a .csv file to write")
    args = parser.parse_args()
    known = {path.name for folder in [ROOT / "tests/data", *args.seen_before] for path in folder.rglob("*")}
    rows: list[dict[str, str | int]] = []
    for path in drawn(args.scenes, known, args.seed):
        if len(rows) == args.count:
            break
        with tempfile.TemporaryDirectory() as folder:
            try:
                outcome, points, told = tried(path, Path(folder))
            except subprocess.TimeoutExpired:
                outcome, points, told = f"not done in {SECONDS} s", 0, 0
        name = path.relative_to(args.scenes)
        print(f"{outcome:8} {points:8} {told:3} {name}", flush=True)
        if outcome not in ("empty", "unseen"):
            repository, *inner = name.parts
            row = {
                "repository": repository.replace("+", "/", 1),
                "file": "/".join(inner),
                "kind": path.suffix[1:].lower(),
            }
            rows.append({**row, "points": points, "told": told, "same": int(outcome == "same")})
    if args.results:
        with args.results.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
    print(f"{sum(int(row['same']) for row in rows)} of {len(rows)} came back")
    return sum(not row["same"] for row in rows)


if __name__ == "__main__":
    sys.exit(bool(main()))

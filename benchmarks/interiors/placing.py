"""What the shipped models place in interiors that others made, judged apart from the generator's own check.

    python benchmarks/interiors/placing.py FOLDER [--only NAME ...] [--seeds 5] [--out FILE.json]

FOLDER is that of measure.py, or holds NAME.usdc, the interiors converted. Six things are wanted in each interior.
Whether one fits is told by the plan: a free rectangle of its size, up to its height, in the outline marked by eye.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter
from collections.abc import Container
from pathlib import Path
from typing import Any

import numpy as np
from measure import TRUTH, read
from placing_judge import Judge

from unisg_blender.experiments.reports import write_results
from unisg_blender.formats import read_scene_file
from unisg_blender.generate import Generator
from unisg_blender.pretrained import find_generator
from unisg_blender.scene import SceneGraph

WANTED = {
    "living_room": ("Sofa", "Chair", "Coffee Table", "Bookshelf", "Floor Lamp", "Picture"),
    "operating_room": ("Trolley", "IV Pole", "Stool", "Cabinet", "Waste Bin", "Clock"),
}
MOUNTED = {"Picture", "Clock"}
FAULTS = ("outside", "in the air", "tips", "in something", "cuts off")


def main() -> None:
    """Place, judge and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--only", nargs="+", default=[], help="names of interiors")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    generators = {name: Generator.load(find_generator(name)) for name in WANTED}
    rows: list[dict[str, Any]] = []
    entries = {entry["name"]: entry for entry in json.loads(TRUTH.read_text("utf8"))["interiors"]}
    for entry in entries.values() if not args.only else (entries[name] for name in args.only if name in entries):
        rows += placed(entry, args.folder, generators, range(args.first_seed, args.first_seed + args.seeds))
        report(rows, args.out, entries)


def interior(entry: dict[str, Any], folder: Path) -> SceneGraph:
    """An interior, converted or from its source."""
    converted = folder / f"{entry['name']}.usdc"
    return read_scene_file(converted)[0] if converted.is_file() else read(entry, folder)


def placed(entry: dict[str, Any], folder: Path, generators: dict[str, Generator], seeds: range) -> list[dict[str, Any]]:
    """A record for each thing that was asked for."""
    try:
        graph = interior(entry, folder)
    except (ImportError, OSError) as problem:
        print(f"{entry['name']}: {problem}")
        return []
    judge, rows = Judge(graph, entry["storeys"]), []
    for model, generator in generators.items():
        fits = {name: has_room(judge, generator, name) for name in WANTED[model]}
        for seed in seeds:
            start = time.perf_counter()
            made = generator.add(graph, dict.fromkeys(WANTED[model], 1), seed, behaviour=False)
            seconds = time.perf_counter() - start
            things = {made.scene.row_of_uid[item.uid]: item.category in MOUNTED for item in made.objects if item.uid}
            verdicts = judge.verdicts(made.scene, things)
            for item in made.objects:
                wrong = verdicts[made.scene.row_of_uid[item.uid]] if item.uid else []
                row = {"interior": entry["name"], "model": model, "seed": seed, "thing": item.category}
                row |= {"fits": fits[item.category], "placed": bool(item.uid), "wrong": wrong, "note": item.note}
                row |= {"at": item.world[:3, 3].round(2).tolist() if item.uid else [], "on": item.support}
                rows.append(row | {"seconds": round(seconds, 2)})
                if wrong:
                    print(json.dumps(rows[-1]), flush=True)
        own = [row for row in rows if row["model"] == model]
        notes = Counter(f"{row['thing']}: {row['note']}" for row in own if not row["placed"])
        print(entry["name"], model, f"{sum(r['placed'] for r in own)}/{len(own)}, fit {sum(r['fits'] for r in own)}",
              f"{np.mean([r['seconds'] for r in own]):.1f} s", dict(notes), flush=True)  # fmt: skip
    return rows


def has_room(judge: Judge, generator: Generator, name: str) -> bool:
    """Is there room for a thing on a marked storey? What hangs on walls fits where anything does."""
    size = np.array(generator.contract.priors.sizes[name])
    if name in MOUNTED:
        return True
    for storey in judge.storeys:
        plan = judge.plan(storey)
        if plan.room_for(size[:2] / 2, size[2], plan.cells(judge.room, 0.05, float(size[2]))):
            return True
    return False


def report(rows: list[dict[str, Any]], out: Path | None, entries: Container[str]) -> None:
    """Print totals, and write the record; what it has of other interiors of the list and seeds already stays there."""
    known = json.loads(out.read_text("utf8"))["rows"] if out is not None and out.is_file() else []
    done = {(row["interior"], row["seed"]) for row in rows}
    rows = [row for row in known if row["interior"] in entries and (row["interior"], row["seed"]) not in done] + rows
    print(json.dumps(totals(rows)), flush=True)
    if out is not None:
        each = [
            {"interior": name} | totals([row for row in rows if row["interior"] == name])
            for name in sorted({row["interior"] for row in rows})
        ]
        write_results(out, {"totals": totals(rows), "interiors": each, "rows": rows})


def totals(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """How many things were placed, of those for which there is room, and what is wrong with them."""
    stands, fit = [row for row in rows if row["placed"]], [row for row in rows if row["fits"]]
    found: dict[str, Any] = {
        "count": len({row["interior"] for row in rows}),
        "seeds": len({row["seed"] for row in rows}),
    }
    found |= {"wanted": len(rows), "placed": len(stands), "fit": len(fit)}
    found |= {"placed_of_fitting": round(sum(row["placed"] for row in fit) / max(len(fit), 1), 3)}
    found |= {name.replace(" ", "_"): sum(name in row["wrong"] for row in stands) for name in FAULTS}
    return found


if __name__ == "__main__":
    main()

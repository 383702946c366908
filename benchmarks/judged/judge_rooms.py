"""Rooms before judges that are not ours: SceneEval's own code, and MuJoCo; beside them our own meters.

    python benchmarks/judged/judge_rooms.py rooms SCENEEVAL [--rooms 30] [--out FILE.json]
    python benchmarks/judged/judge_rooms.py added INTERIORS [--seeds 1] [--out FILE.json]

SCENEEVAL is a clone of https://github.com/3dlg-hcvc/SceneEval, used as it is (sceneeval.py says what it needs).
INTERIORS is the folder of benchmarks/interiors/placing.py: six things are wanted in each interior, and those that were
placed are simulated with all else firm. Both keep what the file has of the other, and go on where they were stopped.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections import Counter
from collections.abc import Callable
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

sys.path.append(str(Path(__file__).parent.parent / "interiors"))

from unisg_blender.experiments.reports import write_results
from unisg_blender.formats.scene_files import write_scene_file
from unisg_blender.generate import Generator
from unisg_blender.metrics.judges.judged_scene import PARTED, judge_scene, ratio, ratio_interval
from unisg_blender.metrics.scene_validity import measure_scene
from unisg_blender.pretrained import find_generator
from unisg_blender.scene import SceneBuilder, SceneGraph
from unisg_blender.worlds import WORLDS

Make = Callable[[int], SceneGraph]
FLAT = "rug"
"""What SceneEval takes for an obstacle and people walk over."""


def main() -> None:
    """Judge and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("rooms", "added"))
    parser.add_argument("folder", type=Path)
    parser.add_argument("--rooms", type=int, default=30)
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--out", type=Path, default=Path("judged.json"))
    args = parser.parse_args()
    known = json.loads(args.out.read_text("utf8")) if args.out.is_file() else {}
    records = known.get("records", [])
    done = {(row["set"], row["seed"], row.get("interior", "")) for row in records}
    steps = judged_rooms(args, done) if args.what == "rooms" else judged_additions(args, done)
    for record in steps:
        records.append(record)
        sets = {row["set"]: [each for each in records if each["set"] == row["set"]] for row in records}
        rows = [{"set": name} | totals(each) for name, each in sets.items()]
        write_results(args.out, {"rows": rows, "records": records})
        print(json.dumps({key: value for key, value in record.items() if key != "falling"}), flush=True)


def judged_rooms(args: argparse.Namespace, done: set[Any]) -> Any:
    """A record for each room of each set."""
    import sceneeval

    sceneeval.load(args.folder)
    sets: dict[str, Make] = {}
    for model, world in (("living_room", "living-room"), ("operating_room", "operating-room")):
        generator = Generator.load(find_generator(model))
        sets[f"{world}, generated"] = partial(from_nothing, generator, True)
        sets[f"{world}, procedural"] = WORLDS[world]
        if model == "living_room":
            sets[f"{world}, generated, ways not kept"] = partial(from_nothing, generator, False)
    for seed in range(args.rooms):
        for name, make in sets.items():
            if (name, seed, "") not in done:
                scene = make(seed)
                yield {"set": name, "seed": seed} | asdict(judge_scene(scene)) | ours(scene) | theirs(scene, sceneeval)


def from_nothing(generator: Generator, ways: bool, seed: int) -> SceneGraph:
    """A room made by a model, as ``unisg generate --seed`` makes it."""
    empty = SceneBuilder("Room").build()
    counts = generator.sample_counts(np.random.default_rng(seed), empty)
    return generator.add(empty, counts, seed, behaviour=False, ways=ways).scene


def ours(scene: SceneGraph) -> dict[str, Any]:
    """Our own meter."""
    report = measure_scene(scene)
    return {"our_collide": int(report.colliding.sum()), "our_outside": int(report.outside.sum())}


def theirs(scene: SceneGraph, sceneeval: Any) -> dict[str, Any]:
    """SceneEval, and its navigability where nothing is to be walked over."""
    with tempfile.TemporaryDirectory() as name:
        state, out = Path(name) / "room.scenestate.json", Path(name) / "out"
        write_scene_file(scene, state)
        said = sceneeval.judged(state, out)
        bare = sceneeval.navigability_without(state, out, FLAT)
    pairs = Counter(tuple(sorted(each.partition(" - instance")[0] for each in pair)) for pair in said["pairs"])
    return {
        "se_things": said["objects"], "se_collide": len(said["collide"]), "se_outside": len(said["outside"]),
        "se_outside_names": [each.partition(" - instance")[0] for each in said["outside"]],
        "se_navigability": said["navigability"], "se_navigability_bare": bare,
        "se_pairs": [" / ".join(pair) for pair in pairs],
        **{f"se_{kind}{end}": said[f"{kind}{end}"] for kind in ("doors", "windows") for end in ("", "_clear")},
    }  # fmt: skip


def judged_additions(args: argparse.Namespace, done: set[Any]) -> Any:
    """A record for each interior and model."""
    from placing import TRUTH, WANTED, interior

    generators = {name: Generator.load(find_generator(name)) for name in WANTED}
    for entry in json.loads(TRUTH.read_text("utf8"))["interiors"]:
        todo = [(model, seed) for model in WANTED for seed in range(args.seeds)]
        todo = [each for each in todo if (f"added, {each[0]}", each[1], entry["name"]) not in done]
        graph = interior(entry, args.folder) if todo else None
        for model, seed in todo:
            made = generators[model].add(graph, dict.fromkeys(WANTED[model], 1), seed, behaviour=False)
            rows = [made.scene.row_of_uid[item.uid] for item in made.objects if item.uid]
            judged = asdict(judge_scene(made.scene, ("stability",), rows))
            yield {"set": f"added, {model}", "seed": seed, "interior": entry["name"], "placed": len(rows)} | judged


SHARES = {
    "stable": ("stable", "free"), "our_collide": ("our_collide", "things"), "our_outside": ("our_outside", "things"),
    "se_collide": ("se_collide", "se_things"), "se_outside": ("se_outside", "se_things"),
    "doors_clear": ("doors_clear", "doors"), "windows_clear": ("windows_clear", "windows"),
    "se_doors_clear": ("se_doors_clear", "se_doors"), "se_windows_clear": ("se_windows_clear", "se_windows"),
}  # fmt: skip


def totals(records: list[dict[str, Any]]) -> dict[str, Any]:
    """A row of the table: shares over all things with 95 % intervals over rooms, navigability by rooms."""
    row: dict[str, Any] = {"rooms": len(records), "things": sum(record["things"] for record in records)}
    row["placed"] = sum(record.get("placed", 0) for record in records)
    for name, (part, whole) in SHARES.items():
        counts = np.array([(each.get(part) or 0, each.get(whole) or 0) for each in records], float)
        if counts[:, 1].sum():
            row |= {whole: int(counts[:, 1].sum()), name: ratio(counts), f"{name}_interval": ratio_interval(counts)}
    for name in ("navigability", "se_navigability", "se_navigability_bare"):
        values = np.array([record[name] for record in records if record.get(name) is not None], float)
        if len(values):
            mean = np.stack([values, np.ones_like(values)], axis=1)
            row |= {name: ratio(mean), f"{name}_interval": ratio_interval(mean), f"{name}_worst": float(values.min())}
            row[f"{name}_parted"] = int((values < PARTED).sum())
    falls = Counter(name.rpartition(".")[0] or name for record in records for name in record["falling"])
    pairs = Counter(pair for record in records for pair in record.get("se_pairs", ()))
    return row | {"falling": dict(falls.most_common(8)), "se_pairs": dict(pairs.most_common(8))}


if __name__ == "__main__":
    main()

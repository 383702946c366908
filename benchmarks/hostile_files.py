"""Damage scene files by seed, read each in another process, and list what is neither a scene nor one clear refusal.

    python benchmarks/hostile_files.py --kind usda --count 2000 --seed 1 --out build/hostile

Files that make a fault are kept in the folder. ``--results FILE`` keeps how many were read and refused.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from benchmarks.hostile_results import keep
from tests.hostile_files import GUARDED, UNFORESEEN, damaged, is_fault, make_sound_files, outcomes

KINDS = ("usda", "usdc", "usdz", "blend", "glb", "gltf", "json")
AT_ONCE = 100
KEPT = (GUARDED, UNFORESEEN)
"""What is kept beside faults, to look at."""


def main() -> int:
    """Try the files; returns how many kinds had a fault."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kind", action="append", choices=KINDS, help="kind of file (all of them)")
    parser.add_argument("--count", type=int, default=2000, help="files of each kind (2000)")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("build/hostile"))
    parser.add_argument("--results", type=Path, help="a .csv file whose rows of these kinds are replaced")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    make_sound_files(args.out)
    bad = 0
    for kind in args.kind or KINDS:
        told, faults = try_kind(kind, args.count, args.seed, args.out)
        bad += bool(faults)
        print(f"{kind}: {dict(told)}", flush=True)
        if args.results:
            keep(args.results, {"kind": kind, "seed": args.seed, **told})
        for name, outcome in faults.items():
            print(f"  {name}: {outcome.strip().splitlines()[-1][:200]}", flush=True)
    return bad


def try_kind(kind: str, count: int, seed: int, folder: Path) -> tuple[Counter[str], dict[str, str]]:
    """What came of ``count`` damaged files of a kind: how often what, and faults by file name."""
    sound = (folder / f"sound.{kind}").read_bytes()
    told: Counter[str] = Counter(inputs=count)
    faults: dict[str, str] = {}
    for start in range(0, count, AT_ONCE):
        files = []
        for number in range(start, min(start + AT_ONCE, count)):
            rng = np.random.default_rng([seed, number])
            files.append(folder / f"{kind}_{seed}_{number}.{kind}")
            files[-1].write_bytes(damaged(sound, kind, rng))
        found = outcomes(files)
        faults |= {path.name: outcome for path, outcome in found.items() if is_fault(outcome)}
        for file in files:
            outcome = found[file]
            told.update(words_of(outcome))
            if not is_fault(outcome) and not outcome.startswith(KEPT):
                file.unlink()
    told["faults"] = len(faults)
    return told, faults


def words_of(outcome: str) -> list[str]:
    """The columns that count an outcome."""
    if is_fault(outcome):
        return []
    if outcome == "scene":
        return ["read"]
    return ["refused", *["by_guard"] * outcome.startswith(GUARDED), *["unforeseen"] * outcome.startswith(UNFORESEEN)]


if __name__ == "__main__":
    sys.exit(main())

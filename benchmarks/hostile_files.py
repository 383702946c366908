"""Damage scene files by seed, read each in another process, and list what is neither a scene nor one clear refusal.

    python benchmarks/hostile_files.py --kind usda --count 2000 --seed 1 --out build/hostile

Files that make a fault are kept in the folder.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.hostile_files import damaged, is_fault, make_sound_files, outcomes

KINDS = ("usda", "usdc", "usdz", "blend", "glb", "gltf", "json")
AT_ONCE = 100


def main() -> int:
    """Try the files; returns how many kinds had a fault."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kind", action="append", choices=KINDS, help="kind of file (all of them)")
    parser.add_argument("--count", type=int, default=2000, help="files of each kind (2000)")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("build/hostile"))
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    make_sound_files(args.out)
    bad = 0
    for kind in args.kind or KINDS:
        faults = try_kind(kind, args.count, args.seed, args.out)
        bad += bool(faults)
        print(f"{kind}: {args.count} files, {len(faults)} faults", flush=True)
        for name, outcome in faults.items():
            print(f"  {name}: {outcome.strip().splitlines()[-1][:200]}", flush=True)
    return bad


def try_kind(kind: str, count: int, seed: int, folder: Path) -> dict[str, str]:
    """Faults by file name among ``count`` damaged files of a kind."""
    sound = (folder / f"sound.{kind}").read_bytes()
    faults: dict[str, str] = {}
    for start in range(0, count, AT_ONCE):
        files = []
        for number in range(start, min(start + AT_ONCE, count)):
            rng = np.random.default_rng([seed, number])
            files.append(folder / f"{kind}_{seed}_{number}.{kind}")
            files[-1].write_bytes(damaged(sound, kind in ("usda", "gltf", "json"), rng))
        found = outcomes(files)
        for file in files:
            if is_fault(found[file]):
                faults[file.name] = found[file]
            else:
                file.unlink()
        faults |= {str(path): outcome for path, outcome in found.items() if path not in files}
    return faults


if __name__ == "__main__":
    sys.exit(main())

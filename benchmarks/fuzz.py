"""Hostile inputs, many of them: every one must end in success or in one line that says what is wrong.

``python benchmarks/fuzz.py KIND --count 2000 --seed 0``; the same seed gives the same inputs. It prints what ended
otherwise, by kind of error with the first number that made it, and how long the slowest took; exit status 1 if there
was any. ``--only NUMBER`` tries one again and shows its traceback.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import os
import sys
import tempfile
import time
import traceback
import warnings
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from benchmarks import fuzz_data, fuzz_words  # noqa: E402 (they import the library beside this folder)
from benchmarks.hostile_results import keep  # noqa: E402
from unisg_blender.errors import UniSGError  # noqa: E402

Case = Callable[[], object]
"""Tries one input; what it raises besides UniSGError is a fault."""

Kind = Callable[[Path], Callable[[np.random.Generator], Case]]
"""Prepares a folder; gives what makes a case of random numbers."""


def _prepare_properties(folder: Path) -> Callable[[np.random.Generator], Case]:
    from benchmarks import fuzz_properties  # needs Blender

    return fuzz_properties.prepare(folder)


KINDS: dict[str, Kind] = {
    "words": fuzz_words.prepare,
    "models": fuzz_data.prepare_models,
    "datasets": fuzz_data.prepare_datasets,
    "properties": _prepare_properties,
}
LONGEST = 10.0
"""Seconds of processor time that an input may take, or six times as many on a busy clock."""


@dataclass
class Tally:
    """What came of the inputs: how many were read, how many refused, and the numbers of the others by what they did."""

    read: int = 0
    refused: int = 0
    faults: dict[str, list[int]] = field(default_factory=lambda: defaultdict(list))
    slowest: float = 0.0
    slowest_number: int = -1

    def lines(self) -> list[str]:
        """The tally in words."""
        faulty = sum(map(len, self.faults.values()))
        lines = [f"{self.read} read, {self.refused} refused, {faulty} faults; slowest {self.slowest:.1f} s "
                 f"(number {self.slowest_number})"]  # fmt: skip
        ordered = sorted(self.faults.items(), key=lambda item: -len(item[1]))
        return lines + [f"{len(numbers)} x {what} (first: number {numbers[0]})" for what, numbers in ordered]


def run(kind: str, count: int, seed: int = 0, only: int | None = None) -> Tally:
    """Try inputs of a kind; with ``only`` just that number, whose fault is raised."""
    tally = Tally()
    with tempfile.TemporaryDirectory(prefix="unisg-fuzz-") as name:
        make = KINDS[kind](Path(name))
        for number in range(count) if only is None else [only]:
            case = make(np.random.default_rng([seed, number]))
            begin, busy = time.perf_counter(), sum(os.times()[:4])
            try:
                with _silence():
                    case()
                tally.read += 1
            except UniSGError as error:
                tally.refused += 1
                if not str(error) or len(str(error)) > 1000:
                    tally.faults[f"a message of {len(str(error))} characters"].append(number)
            except Exception as error:
                if only is not None:
                    raise
                tally.faults[_place(error)].append(number)
            seconds = time.perf_counter() - begin
            if seconds > 6 * LONGEST or sum(os.times()[:4]) - busy > LONGEST:
                tally.faults[f"more than {LONGEST:g} s"].append(number)
            if seconds > tally.slowest:
                tally.slowest, tally.slowest_number = seconds, number
    return tally


@contextlib.contextmanager
def _silence():
    with (
        contextlib.redirect_stdout(io.StringIO()),
        contextlib.redirect_stderr(io.StringIO()),
        warnings.catch_warnings(),
        np.errstate(all="ignore"),
    ):
        warnings.simplefilter("ignore")
        yield


def _place(error: Exception) -> str:
    """An error by its class, its message and the last line of the library that it passed."""
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if "unisg_blender/" in frame.filename]
    where = f"{frames[-1].filename.split('unisg_blender/')[-1]}:{frames[-1].lineno}" if frames else "?"
    return f"{type(error).__name__} at {where}: {' '.join(str(error).split())[:80]}"


def main() -> int:
    """Try, and print the tally."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", type=int)
    parser.add_argument("--results", type=Path, help="a .csv file whose row of this kind is replaced")
    args = parser.parse_args()
    tally = run(args.kind, args.count, args.seed, args.only)
    print("\n".join(tally.lines()))
    if args.results:
        faults = sum(map(len, tally.faults.values()))
        told = {"read": tally.read, "refused": tally.refused, "faults": faults, "seed": args.seed}
        keep(args.results, {"kind": args.kind, "inputs": args.count, **told})
    return int(bool(tally.faults))


if __name__ == "__main__":
    from unisg_blender.runtime.process_end import end_process

    end_process(main())

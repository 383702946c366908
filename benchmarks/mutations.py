"""Mutation check: change one operator of a room at random, and see whether the room's tests notice.

    python benchmarks/mutations.py --room poses --count 20 --seed 1 [--tests tests/poses] [--fast]

Works in a temporary copy of the checkout. Prints every change that no test noticed, with file and line, and how many
were noticed. Such a change is a hole in the tests, or makes no difference (a bound of which both sides are allowed).
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LEFT_OUT = shutil.ignore_patterns(".git", ".venv*", "build", "demo", "__pycache__", ".*_cache", ".hypothesis")
SWAPS: dict[type[ast.AST], type[ast.AST]] = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.FloorDiv: ast.Mult,
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.And: ast.Or, ast.Or: ast.And, ast.In: ast.NotIn, ast.NotIn: ast.In, ast.Is: ast.IsNot, ast.IsNot: ast.Is,
    ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd, ast.USub: ast.UAdd,
}  # fmt: skip


@dataclass(frozen=True)
class Mutation:
    """One changed expression: where it stands in a file (offsets in bytes), and what stands there instead."""

    path: Path  # relative to the root
    line: int
    start: int
    stop: int
    old: str
    new: str

    def __str__(self) -> str:
        return f"{self.path.as_posix()}:{self.line}: {self.old}  ->  {self.new}"

    def apply(self, source: bytes) -> bytes:
        """The file with the change."""
        return source[: self.start] + f"({self.new})".encode() + source[self.stop :]


def mutations_of(path: Path) -> Iterator[Mutation]:
    """Every change of one operator in a file; those in annotations and texts are left alone."""
    source = (ROOT / path).read_bytes()
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    tree = ast.parse(source)
    left_alone = {id(part) for node in ast.walk(tree) for part in _left_alone(node)}
    for node in ast.walk(tree):
        if id(node) in left_alone or not isinstance(node, ast.BinOp | ast.Compare | ast.BoolOp | ast.UnaryOp):
            continue
        start = starts[node.lineno - 1] + node.col_offset
        stop = starts[(node.end_lineno or node.lineno) - 1] + (node.end_col_offset or 0)
        old = ast.unparse(node)
        for new in _swapped(node):
            yield Mutation(path, node.lineno, start, stop, old, new)


def _left_alone(node: ast.AST) -> Iterator[ast.AST]:
    """Annotations, and what stands in formatted strings: Python 3.11 does not say where."""
    inside = [node] if isinstance(node, ast.JoinedStr) else []
    inside += [hint for name in ("annotation", "returns") if (hint := getattr(node, name, None)) is not None]
    for part in inside:
        yield from ast.walk(part)


def _swapped(node: ast.BinOp | ast.Compare | ast.BoolOp | ast.UnaryOp) -> Iterator[str]:
    """The expression with one of its operators changed."""
    if isinstance(node, ast.Compare):
        for place, operator in enumerate(node.ops):
            if swap := SWAPS.get(type(operator)):
                node.ops[place] = swap()  # type: ignore[assignment]
                yield ast.unparse(node)
                node.ops[place] = operator
    elif swap := SWAPS.get(type(node.op)):
        kept, node.op = node.op, swap()  # type: ignore[assignment]
        yield ast.unparse(node)
        node.op = kept  # type: ignore[assignment]


def run_tests(copy: Path, tests: list[str], workers: int, seconds: float) -> int:
    """The exit status of the tests in the copy; what takes too long counts as failed."""
    words = ["-x", "-q", "-p", "no:cacheprovider", "-n", str(workers), "--dist", "loadfile", "--timeout", str(seconds)]
    environment = os.environ | {"PYTHONPATH": str(copy), "PYTHONDONTWRITEBYTECODE": "1"}
    try:
        return subprocess.run(
            [sys.executable, "-m", "pytest", *words, *tests],
            cwd=copy, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=3 * seconds,
        ).returncode  # fmt: skip
    except subprocess.TimeoutExpired:
        return 1


def check(room: str, tests: list[str], count: int, seed: int, workers: int, seconds: float) -> None:
    """Draw the changes, try one after another, print what stayed unseen."""
    folder = Path("unisg_blender") / room
    files = sorted(path.relative_to(ROOT) for path in (ROOT / folder).rglob("*.py"))
    found = [mutation for path in files for mutation in mutations_of(path)]
    if not found:
        sys.exit(f"no operators in {folder}")
    drawn = random.Random(seed).sample(found, min(count, len(found)))
    with tempfile.TemporaryDirectory() as name:
        copy = Path(name) / "copy"
        shutil.copytree(ROOT, copy, ignore=LEFT_OUT)
        if run_tests(copy, tests, workers, seconds):
            sys.exit(f"{' '.join(tests)}: the tests must pass before anything is changed")
        unseen = 0
        for number, mutation in enumerate(drawn, start=1):
            before = (copy / mutation.path).read_bytes()
            (copy / mutation.path).write_bytes(mutation.apply(before))
            if run_tests(copy, tests, workers, seconds) == 0:
                unseen += 1
                print(f"unseen  {mutation}", flush=True)
            (copy / mutation.path).write_bytes(before)
            print(f"{number} of {len(drawn)}, {unseen} unseen", end="\r", file=sys.stderr, flush=True)
    print(f"{len(drawn) - unseen} of {len(drawn)} noticed ({len(found)} possible changes in {room}, seed {seed})")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--room", required=True, help="folder in unisg_blender/, such as poses or behaviour/play")
    parser.add_argument("--tests", nargs="+", help="what has to notice (default: tests/ROOM)")
    parser.add_argument("--count", type=int, default=20, help="changes to try (default: 20)")
    parser.add_argument("--seed", type=int, default=1, help="same seed, same changes (default: 1)")
    parser.add_argument("--workers", type=int, default=2, help="processes for the tests (default: 2)")
    parser.add_argument("--seconds", type=float, default=300, help="a test that takes longer has failed (default: 300)")
    parser.add_argument("--fast", action="store_true", help="leave out the tests that are marked slow")
    args = parser.parse_args()
    tests = [*(args.tests or [f"tests/{args.room.split('/')[0]}"]), *(["-m", "not slow"] if args.fast else [])]
    check(args.room, tests, args.count, args.seed, args.workers, args.seconds)

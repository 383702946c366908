"""Mutation check: change one operator at random, and see whether the tests notice.

    python benchmarks/mutations.py --room poses --count 20 --seed 1 [--tests tests/poses] [--fast]

    pytest -n 2 --dist loadfile --cov=unisg_blender --cov-context=test --cov-report=
    python benchmarks/mutations.py --count 200 --seed 1 --coverage .coverage

With a coverage file that says which test runs which line, each change is tried by the tests that run it, at most
``--most`` of them, and where none is known by the tests of the room. Works in a temporary copy of the checkout. Prints
every change that no test noticed, with file and line, and how many were noticed. Such a change is a hole in the tests,
or makes no difference (a bound of which both sides are allowed).
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import re
import shutil
import sqlite3
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LEFT_OUT = shutil.ignore_patterns(".git", ".venv*", "build", "demo", "__pycache__", ".*_cache", ".hypothesis")
NOTHING_TO_RUN = 5  # pytest's exit status when every test was left out
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
                node.ops[place] = swap()  # type: ignore[call-overload]
                yield ast.unparse(node)
                node.ops[place] = operator
    elif swap := SWAPS.get(type(node.op)):
        kept, node.op = node.op, swap()  # type: ignore[assignment]
        yield ast.unparse(node)
        node.op = kept


def failing_test(copy: Path, tests: list[str], broken: set[str], args: argparse.Namespace) -> str:
    """The first test that fails in the copy ("" for none), or in words that nothing could be run in that time."""
    words = ["-x", "-q", "-rfE", "-p", "no:cacheprovider", "--timeout", str(args.seconds)]
    words += ["-n", str(args.workers), "--dist", "loadfile"] if args.workers > 1 else []
    words += [f"--deselect={test}" for test in sorted(broken)]
    environment = os.environ | {"PYTHONPATH": str(copy), "PYTHONDONTWRITEBYTECODE": "1"}
    chosen = copy / "chosen-tests.txt"  # more than fit on a command line
    chosen.write_text("\n".join(tests), encoding="utf-8")
    try:
        done = subprocess.run(
            [sys.executable, "-m", "pytest", *words, f"@{chosen}"],
            cwd=copy, env=environment, capture_output=True, text=True, timeout=3 * args.seconds,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return "not done in time"
    failed = re.search(r"^(?:FAILED|ERROR) (\S+::.+?)(?: - .*)?$", done.stdout, re.MULTILINE)
    return "" if done.returncode in (0, NOTHING_TO_RUN) else failed[1] if failed else "no test could be run"


def covering_tests(coverage: Path, mutation: Mutation, most: int) -> list[str]:
    """Tests that run the line: the room's own first, and one case of each test before its other cases."""
    room = mutation.path.parts[1]
    with sqlite3.connect(coverage) as data:
        rows = data.execute(
            "SELECT context.context, line_bits.numbits FROM line_bits JOIN context ON context.id = context_id"
            " JOIN file ON file.id = file_id WHERE file.path LIKE ?",
            (f"%/{mutation.path.as_posix()}",),
        ).fetchall()
    where, bit = divmod(mutation.line, 8)
    running = sorted(
        {name.split("|")[0] for name, bits in rows if name and where < len(bits) and bits[where] >> bit & 1}
    )
    seen: Counter[str] = Counter()
    ordered = []
    for name in running:
        function = name.split("[")[0]
        ordered.append((seen[function], not name.startswith(f"tests/{room}/"), name))
        seen[function] += 1
    return [name for _, _, name in sorted(ordered)[:most]]


def drawn_mutations(room: str, count: int, seed: int) -> tuple[list[Mutation], int]:
    """Changes drawn at random from a room, or from the whole library, and how many are possible."""
    folder = ROOT / "unisg_blender" / room
    found = [mutation for path in sorted(folder.rglob("*.py")) for mutation in mutations_of(path.relative_to(ROOT))]
    if not found:
        sys.exit(f"no operators in {folder}")
    return random.Random(seed).sample(found, min(count, len(found))), len(found)


def noticed(copy: Path, mutation: Mutation, tests: list[str], broken: set[str], args: argparse.Namespace) -> bool:
    """Whether a test fails with the change and passes without; tests that fail without it are added to ``broken``."""
    before = (copy / mutation.path).read_bytes()
    while True:
        (copy / mutation.path).write_bytes(mutation.apply(before))
        failing = failing_test(copy, tests, broken, args)
        (copy / mutation.path).write_bytes(before)
        if "::" not in failing:
            return bool(failing)
        if not failing_test(copy, [failing], set(), args):
            return True
        broken.add(failing)


def check(args: argparse.Namespace) -> None:
    """Draw the changes, try one after another, print what stayed unseen."""
    drawn, possible = drawn_mutations(args.room, args.count, args.seed)
    unseen, broken = 0, set[str]()
    with tempfile.TemporaryDirectory() as name:
        copy = Path(name) / "copy"
        shutil.copytree(ROOT, copy, ignore=LEFT_OUT)
        for number, mutation in enumerate(drawn, start=1):
            tests = covering_tests(args.coverage, mutation, args.most) if args.coverage else []
            tests = tests or tests_of(args, mutation.path.parts[1])
            if not noticed(copy, mutation, [*tests, *(["-m", "not slow"] if args.fast else [])], broken, args):
                unseen += 1
                print(f"unseen  {mutation}", flush=True)
            print(f"{number} of {len(drawn)}, {unseen} unseen", end="\r", file=sys.stderr, flush=True)
    print(f"{len(drawn) - unseen} of {len(drawn)} noticed ({possible} possible changes, seed {args.seed})")
    print(*(f"fails without a change: {test}" for test in sorted(broken)), sep="\n")


def tests_of(args: argparse.Namespace, room: str) -> list[str]:
    """The tests named by the user, else those of a room, else all."""
    own = f"tests/{room.split('/')[0]}" if room else "tests"
    return args.tests or [own if (ROOT / own).is_dir() else "tests"]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument(
        "--room", default="", help="folder in unisg_blender/, such as poses (default: the whole library)"
    )
    parser.add_argument("--tests", nargs="+", help="what has to notice (default: tests/ROOM)")
    parser.add_argument("--count", type=int, default=20, help="changes to try (default: 20)")
    parser.add_argument("--seed", type=int, default=1, help="same seed, same changes (default: 1)")
    parser.add_argument("--workers", type=int, default=2, help="processes for the tests (default: 2)")
    parser.add_argument("--seconds", type=float, default=300, help="a test that takes longer has failed (default: 300)")
    parser.add_argument("--fast", action="store_true", help="leave out the tests that are marked slow")
    parser.add_argument("--coverage", type=Path, help="a .coverage file with test contexts: choose tests by line")
    parser.add_argument("--most", type=int, default=150, help="with --coverage, tests for one change (default: 150)")
    check(parser.parse_args())

"""Mutation check: change one operator at random, and see whether the tests notice.

    python benchmarks/mutations.py --room poses --count 20 --seed 1 [--tests tests/poses] [--fast]

    pytest -m "not slow" -n 2 --dist loadfile --cov=unisg_blender --cov-context=test --cov-report=
    python benchmarks/mutations.py --count 200 --seed 1 --coverage .coverage --fast --results FILE.csv
    python benchmarks/mutations.py --count 200 --seed 1 --coverage .coverage --results FILE.csv --more

With a coverage file that says which test runs which line, each change is tried by the tests that run it, at most
``--most`` of them, and where none is known by the tests of the room. The last line tries what those did not notice with
more of them, and with all tests of its room. Works in a temporary copy of the checkout. Prints
every change that no test noticed, with file and line, and how many were noticed. Such a change is a hole in the tests,
or makes no difference (a bound of which both sides are allowed).
"""

from __future__ import annotations

import argparse
import ast
import compileall
import importlib
import os
import random
import re
import shutil
import signal
import sqlite3
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[1]))

from benchmarks.mutation_results import Row, keep, kept

ROOT = Path(__file__).resolve().parent.parent
LEFT_OUT = shutil.ignore_patterns(".git", ".venv*", "build", "demo", "__pycache__", ".*_cache", ".hypothesis")
OF_OTHERS = ("matplotlib", "scipy.spatial", "trimesh", "torch", "torch_geometric", "pytorch_lightning", "onnxruntime")
"""What is loaded once, not for every change; not Blender, whose threads do not live in a forked process."""
AT_ONCE = 10
MOST_OTHERS = 200
"""Before all tests of a room, so many of those that run the line are tried."""

NOTHING_RAN = "no test could be run"
UNSEEN = "no"
TOLD = "told.txt"
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


def failing_tests(copy: Path, words: list[str], broken: set[str], args: argparse.Namespace) -> list[str]:
    """The tests that fail in the copy, or in words that none could be run; none if there was too little time."""
    words = ["-q", "-rfE", "-p", "no:cacheprovider", "--timeout", str(args.seconds), *words]
    words += ["-n", str(args.workers), "--dist", "loadfile"] if args.workers > 1 else []
    process = get_context("fork").Process(target=run_tests, args=(copy, words + [f"--deselect={t}" for t in broken]))
    process.start()
    process.join(3 * args.seconds)
    if process.exitcode is None:
        os.killpg(process.pid or 0, signal.SIGKILL)
        process.join()
        return []  # what hangs is told of its test before that, or it is the machine that is busy
    told = (copy / TOLD).read_text(errors="replace")
    failed = re.findall(r"^(?:FAILED|ERROR) (\S+::.+?)(?: - .*)?$", told, re.MULTILINE)
    return [] if process.exitcode in (0, NOTHING_TO_RUN) else failed or [NOTHING_RAN]


def run_tests(copy: Path, words: list[str]) -> None:
    """Run pytest in this process, which has the libraries of others loaded already, and end it."""
    os.setsid()
    os.chdir(copy)
    sys.path[0] = str(copy)
    os.environ |= {"PYTHONPATH": str(copy), "PYTHONDONTWRITEBYTECODE": "1"}
    with (copy / TOLD).open("wb") as file:
        os.dup2(file.fileno(), 1)
        os.dup2(file.fileno(), 2)
    status = pytest.main(words)
    sys.stdout.flush()
    os._exit(status)


def covering_tests(coverage: Path, mutation: Mutation) -> tuple[list[str], bool]:
    """Tests that run the line: the room's own first, and one case of each test before its other cases; and whether it
    is run while modules are loaded, for whichever test that is.
    """
    room = mutation.path.parts[1]
    with sqlite3.connect(coverage) as data:
        rows = data.execute(
            "SELECT context.context, line_bits.numbits FROM line_bits JOIN context ON context.id = context_id"
            " JOIN file ON file.id = file_id WHERE file.path LIKE ?",
            (f"%/{mutation.path.as_posix()}",),
        ).fetchall()
    where, bit = divmod(mutation.line, 8)
    running = sorted({name.rpartition("|")[0] for name, bits in rows if where < len(bits) and bits[where] >> bit & 1})
    seen: Counter[str] = Counter()
    ordered = []
    for name in filter(None, running):
        function = name.split("[")[0]
        ordered.append((seen[function], not name.startswith(f"tests/{room}/"), name))
        seen[function] += 1
    return [name for _, _, name in sorted(ordered)], "" in running


def drawn_mutations(room: str, count: int, seed: int) -> tuple[list[Mutation], int]:
    """Changes drawn at random from a room, or from the whole library, and how many are possible."""
    folder = ROOT / "unisg_blender" / room
    found = [mutation for path in sorted(folder.rglob("*.py")) for mutation in mutations_of(path.relative_to(ROOT))]
    if not found:
        sys.exit(f"no operators in {folder}")
    return random.Random(seed).sample(found, min(count, len(found))), len(found)


def claim(copy: Path, mutation: Mutation, broken: set[str], args: argparse.Namespace) -> str:
    """The first test that fails with the change, "" for none."""
    covering, early = covering_tests(args.coverage, mutation) if args.coverage else ([], True)
    room, marks = tests_of(args, mutation.path.parts[1]), ["-m", "not slow"] if args.fast else []
    few = not covering or (early and len(covering) < args.most)
    tries = [["-x", *marks, *covering[: args.most], *room * few]]
    if args.more:
        others = covering[args.most : MOST_OTHERS]
        tries = [["-x", *marks, *others]] * bool(others)
        tries.append(["-x", *room])  # what is cached was run by one test only, though others need it
    before = (copy / mutation.path).read_bytes()
    for words in tries:
        (copy / mutation.path).write_bytes(mutation.apply(before))
        try:
            failing = failing_tests(copy, words, broken, args)
        finally:
            (copy / mutation.path).write_bytes(before)
        if NOTHING_RAN in failing and NOTHING_RAN in failing_tests(copy, words, broken, args):
            sys.exit((copy / TOLD).read_text(errors="replace"))
        if failing:
            return failing[0]
    return ""


def unsound(copy: Path, claims: Iterable[str], args: argparse.Namespace) -> set[str]:
    """Those of the tests that fail without a change as well."""
    tests = sorted({test for test in claims if "::" in test})
    return set(failing_tests(copy, tests, set(), args) if tests else [])


def check(args: argparse.Namespace) -> None:
    """Draw the changes, try some after the other and then their tests without a change, print what stayed unseen."""
    for name in OF_OTHERS:
        with suppress(ImportError):
            importlib.import_module(name)
    drawn, possible = drawn_mutations(args.room, args.count, args.seed)
    seen, broken = kept(args.results, args.seed), set[str]()
    left = [number for number in range(len(drawn)) if to_try(seen.get(number), args.more)]
    end = time.monotonic() + 60 * args.minutes
    with tempfile.TemporaryDirectory() as name:
        copy = Path(name) / "copy"
        shutil.copytree(ROOT, copy, ignore=LEFT_OUT)
        compileall.compile_dir(copy, quiet=2)  # read by every run; what is changed is compiled anew
        while left and time.monotonic() < end:
            now, left = left[:AT_ONCE], left[AT_ONCE:]
            claims = {number: claim(copy, drawn[number], broken, args) for number in now}
            broken |= unsound(copy, claims.values(), args)
            left = [number for number in now if claims[number] in broken] + left
            for number in sorted(set(now) - set(left)):
                seen[number] = row_of(drawn[number], number, claims[number], args)
                if args.results:
                    keep(args.results, seen[number])
            print(f"{len(seen)} of {len(drawn)} tried", end="\r", file=sys.stderr, flush=True)
    told = Counter(row["noticed"] for row in seen.values())
    print(f"{len(seen)} of {len(drawn)} tried ({possible} possible, seed {args.seed}): {dict(told)}")
    print(*(f"fails without a change: {test}" for test in sorted(broken)), sep="\n")


def to_try(row: Row | None, more: bool) -> bool:
    """Whether a change is tried: those not tried yet, or with more tests those that the first did not notice."""
    return row is not None and row["noticed"] == UNSEEN if more else row is None


def row_of(mutation: Mutation, number: int, claimed: str, args: argparse.Namespace) -> Row:
    """What is kept of a change; tells of one that no test noticed."""
    if not claimed:
        print(f"unseen  {mutation}", flush=True)
    place = f"{mutation.path.as_posix()}:{mutation.line}"
    noticed = ("more tests" if args.more else "tests") if claimed else UNSEEN
    facts = {"room": mutation.path.parts[1], "line": place, "old": mutation.old, "new": mutation.new}
    return {"seed": str(args.seed), "number": str(number), **facts, "noticed": noticed}


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
    parser.add_argument("--minutes", type=float, default=float("inf"), help="begin no more changes after so many")
    parser.add_argument("--results", type=Path, help="a .csv file that keeps what was found; a further call goes on")
    parser.add_argument("--more", action="store_true", help="try what is unseen in the results with all tests")
    check(parser.parse_args())

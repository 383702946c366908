"""Lines that use a public name: of pages of the guide, examples or tests, which tests run; or of the library."""

from __future__ import annotations

import ast
import re
import textwrap
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from architecture import LIBRARY, ROOT

PYTHON = re.compile(r"^```python\n(.*?)^```", re.DOTALL | re.MULTILINE)
LONGEST = 45
"""Lines of a test that are still worth reading."""


@dataclass(frozen=True)
class TestedCode:
    """Lines, the file that they stand in, and the names of the library that they use."""

    source: str
    path: Path
    names: frozenset[str]


def example(name: str) -> TestedCode | None:
    """The shortest block of a page, else script, else test that uses a name; None if none does."""
    return _by_name((_pages, _scripts, _tests)).get(name)


def library_example(name: str) -> TestedCode | None:
    """The shortest function of the library that uses a name."""
    return _by_name((_library,)).get(name)


@cache
def _by_name(kinds: tuple[Callable[[], Iterator[TestedCode]], ...]) -> dict[str, TestedCode]:
    found: dict[str, TestedCode] = {}
    for kind in kinds:
        for code in sorted(kind(), key=lambda each: each.source.count("\n")):
            for name in code.names:
                found.setdefault(name, code)
    return found


def _pages() -> Iterator[TestedCode]:
    """The blocks of README.md and the guide; what a block imported, later ones of its page know too."""
    for page in (ROOT / "README.md", *sorted((ROOT / "docs" / "guide").glob("*.md"))):
        imported: set[str] = set()
        for block in PYTHON.findall(page.read_text("utf-8")):
            tree = ast.parse(block)
            imported |= _imported(tree)
            yield TestedCode(block, page, frozenset(imported & _used(tree)))


def _scripts() -> Iterator[TestedCode]:
    for path in sorted((ROOT / "examples").glob("*.py")):
        tree = ast.parse(path.read_text("utf-8"))
        yield TestedCode(path.read_text("utf-8"), path, frozenset(_imported(tree) & _used(tree)))


def _tests() -> Iterator[TestedCode]:
    for path in sorted((ROOT / "tests").rglob("test_*.py")):
        yield from _functions(path)


def _library() -> Iterator[TestedCode]:
    for path in sorted((ROOT / LIBRARY).rglob("*.py")):
        yield from _functions(path, types=True)


def _functions(path: Path, types: bool = False) -> Iterator[TestedCode]:
    text = path.read_text("utf-8")
    tree = ast.parse(text)
    known = _imported(tree) | {node.name for node in tree.body if isinstance(node, ast.ClassDef | ast.FunctionDef)}
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef) and node.end_lineno and node.end_lineno - node.lineno < LONGEST:
            source = textwrap.dedent(" " * node.col_offset + (ast.get_source_segment(text, node) or ""))
            yield TestedCode(
                source + "\n", path, frozenset(_used(node, types) & (known | _imported(node)) - {node.name})
            )


def _imported(tree: ast.AST) -> set[str]:
    """Names that come from the library."""
    lines = (node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom))
    own = (line for line in lines if line.level or (line.module or "").startswith(LIBRARY))
    return {alias.name for line in own for alias in line.names}


def _used(tree: ast.AST, types: bool = False) -> set[str]:
    """Names that stand in expressions, with ``types`` those that say what something is, too."""
    nodes = list(ast.walk(tree))
    if not types:
        said = [getattr(node, kind, None) for node in nodes for kind in ("annotation", "returns")]
        left_out = {node for each in said if isinstance(each, ast.AST) for node in ast.walk(each)}
        nodes = [node for node in nodes if node not in left_out]
    named = {node.id for node in nodes if isinstance(node, ast.Name)}
    return named | {node.attr for node in nodes if isinstance(node, ast.Attribute)}

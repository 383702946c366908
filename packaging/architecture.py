"""The plan of the house: its rooms, the arrows allowed between them, and the imports that there are.

``tests/test_architecture.py`` holds the plan against the imports, ``draw_architecture.py`` draws it.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LIBRARY = "unisg_blender"

# From top to bottom; an import goes to a lower layer, never upward and never to a neighbour.
LAYERS: dict[str, tuple[str, ...]] = {
    "what a user sees": ("panels",),
    "what a user asks for": ("operators",),
    "the command line": ("cli", "commands"),
    "made in number": ("batches",),
    "measured": ("experiments",),
    "trained": ("learn",),
    "judged": ("metrics",),
    "used": ("generate", "predict"),
    "stored for learning": ("dataset",),
    "shown in a browser": ("web",),
    "any scene file": ("formats",),
    "where scenes come from": ("blender", "usd", "worlds", "meshes", "interactivity"),
    "what a scene means": ("spatial", "behaviour", "words"),
    "the scenegraph; arrays": ("scene", "geometry"),
    "forms of a pose": ("poses",),
    "open to every room": ("runtime", "pretrained", "errors"),
}
GROUND = set(LAYERS["open to every room"])

# The rooms whose files a room imports, neither more nor fewer; every room may import the ground, the ground ``errors``.
ARROWS: dict[str, set[str]] = {
    room: set(targets.split())
    for room, targets in {
        "panels": "operators blender scene",
        "operators": "cli batches web generate predict dataset formats blender usd worlds meshes spatial behaviour"
        " words scene poses",
        "cli": "",
        "commands": "web batches experiments learn metrics generate predict dataset formats blender worlds meshes"
        " spatial behaviour words scene poses",
        "batches": "generate dataset formats blender worlds spatial words scene geometry",
        "experiments": "learn metrics generate predict dataset formats blender worlds meshes spatial behaviour scene"
        " geometry poses",
        "learn": "metrics generate predict dataset worlds meshes spatial words scene geometry poses",
        "metrics": "generate dataset spatial scene geometry poses",
        "generate": "dataset spatial behaviour words scene geometry poses",
        "predict": "dataset meshes spatial words scene geometry poses",
        "dataset": "formats spatial behaviour words scene geometry poses",
        "web": "formats interactivity behaviour scene",
        "formats": "blender usd meshes interactivity spatial scene geometry poses",
        "blender": "behaviour scene geometry poses",
        "usd": "scene",
        "interactivity": "behaviour scene geometry poses",
        "worlds": "spatial scene geometry",
        "meshes": "scene geometry",
        "spatial": "scene geometry",
        "words": "scene geometry",
        "behaviour": "scene geometry poses",
        "scene": "poses",
        "geometry": "poses",
        "poses": "",
    }.items()
}


def allowed(room: str) -> set[str]:
    """What a room may import beside itself."""
    return {"errors"} if room in GROUND else ARROWS.get(room, set()) | GROUND


@dataclass(frozen=True)
class Module:
    """One Python file of the extension or the library."""

    name: str  # dotted, as seen from the root: ``unisg_blender.scene.graph``, ``operators.export``
    path: Path  # relative to the root
    source: str

    @property
    def is_package(self) -> bool:
        """Whether the file is a folder's ``__init__.py``."""
        return self.path.name == "__init__.py"

    @property
    def steps(self) -> list[str]:
        """The names from the room downward: ``["scene", "graph"]``; empty for the library's own ``__init__``."""
        parts = self.name.split(".")
        return parts[1:] if parts[0] == LIBRARY else parts

    @property
    def room(self) -> str:
        """The room's name; a file beside the rooms, such as ``errors.py``, is a room of one file."""
        room = self.steps[0] if self.steps else LIBRARY
        return "cli" if room == "__main__" else room

    @property
    def subroom(self) -> str:
        """The folder or file directly inside the room: ``blender.read``, ``generate.generator``."""
        return ".".join(self.steps[:2])

    @property
    def tree(self) -> ast.Module:
        """The parsed file."""
        return _parsed(self.source)


@cache
def _parsed(source: str) -> ast.Module:
    return ast.parse(source)


@cache
def modules() -> dict[str, Module]:
    """Every Python file of the extension and the library, by dotted name."""
    found = {}
    for top in (LIBRARY, "operators", "panels"):
        for file in sorted((ROOT / top).rglob("*.py")):
            path = file.relative_to(ROOT)
            parts = path.with_suffix("").parts
            name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
            found[name] = Module(name, path, file.read_text(encoding="utf-8"))
    return found


@cache
def imported_names(module: Module) -> tuple[tuple[str, bool], ...]:
    """Absolute names of what a file imports, deferred imports and those for types included.

    Returns
    -------
    pairs (name, deferred)
        ``package.module`` or ``package.module.name``; whether the import stands inside a function.
    """
    parts, found = module.name.split("."), []
    waiting: list[tuple[ast.AST, bool]] = [(module.tree, False)]
    while waiting:
        node, deferred = waiting.pop()
        deferred = deferred or isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        if isinstance(node, ast.Import):
            found += [(alias.name, deferred) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            above = parts[: len(parts) - node.level + module.is_package] if node.level else []
            base = [*above, *([node.module] if node.module else [])]
            found += [(".".join([*base, alias.name]), deferred) for alias in node.names]
        elif not isinstance(node, ast.expr):  # an expression imports nothing
            waiting += [(child, deferred) for child in ast.iter_child_nodes(node)]
    return tuple(found)


@cache
def imports() -> tuple[tuple[Module, Module], ...]:
    """Pairs (file, file that it imports), each once, sorted by name."""
    known = modules()
    pairs = set()
    for module in known.values():
        for name, _ in imported_names(module):
            target = known.get(name) or known.get(name.rpartition(".")[0])
            if target and target is not module:
                pairs.add((module.name, target.name))
    return tuple((known[a], known[b]) for a, b in sorted(pairs))


def room_arrows() -> dict[tuple[str, str], int]:
    """Arrows between rooms with the number of imports that make each; those to the ground left out."""
    counts: dict[tuple[str, str], int] = {}
    for source, target in imports():
        pair = (source.room, target.room)
        if pair[0] != pair[1] and not GROUND & set(pair) and LIBRARY not in pair:
            counts[pair] = counts.get(pair, 0) + 1
    return dict(sorted(counts.items()))

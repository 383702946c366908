"""Write docs/api.md: every public name of the library, by package, with its signature and the first line about it.

    python packaging/write_api_page.py

Public is what a package's ``__all__`` names. Files are read, not imported, so neither Blender nor torch is needed.
"""

from __future__ import annotations

import ast
import inspect
from copy import deepcopy
from dataclasses import dataclass

from architecture import LIBRARY, ROOT, Module, imported_names, modules

PAGE = ROOT / "docs" / "api.md"
HEAD = """# Public names

Every name that a package of the library exports, with the first line of what it says about itself;
`help(name)` shows the rest. `python packaging/write_api_page.py` writes this page.
"""


@dataclass(frozen=True)
class PublicName:
    """A name of a package's ``__all__``: its ``signature`` ("" for a constant), and a ``summary`` of one line."""

    name: str
    signature: str
    summary: str


def public_packages() -> dict[str, list[str]]:
    """The names in ``__all__`` by package."""
    found = {}
    for module in modules().values():
        for node in module.tree.body if module.is_package and module.name.startswith(LIBRARY) else ():
            if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__":
                found[module.name] = [name for name in ast.literal_eval(node.value) if not name.startswith("__")]
    return found


def describe(package: str, name: str) -> PublicName:
    """What the file that defines a public name says about it, shortly."""
    node, text = definition(package, name)
    signature = _signature(node) if isinstance(node, ast.FunctionDef | ast.ClassDef) else ""
    return PublicName(name, signature, _first_line(text))


def definition(package: str, name: str) -> tuple[ast.stmt, str]:
    """The statement that defines a public name, and all that is said about it."""
    module = _home(modules()[package], name)
    for node, after in zip(module.tree.body, [*module.tree.body[1:], None], strict=True):
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and node.name == name:
            return node, ast.get_docstring(node) or ""
        if isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            said = after.value if isinstance(after, ast.Expr) else None
            if name in map(ast.unparse, targets):
                text = said.value if isinstance(said, ast.Constant) and isinstance(said.value, str) else ""
                return node, inspect.cleandoc(text)
    raise LookupError(f"{package} exports {name!r}, which {module.path} does not define")


def _home(module: Module, name: str) -> Module:
    """The file that defines a name, over any number of packages that pass it on."""
    known = modules()
    lazy = {found: f"{module.name}{home}" for found, home in _lazy_homes(module).items()}
    passed_on = {full.rpartition(".")[2]: full.rpartition(".")[0] for full, _ in imported_names(module)} | lazy
    home = known.get(passed_on.get(name, ""))
    return module if home is None else _home(home, name)


def _lazy_homes(module: Module) -> dict[str, str]:
    """The rooms of the names that the library itself passes on."""
    for node in module.tree.body:
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "_ROOMS":
            rooms: dict[str, str] = ast.literal_eval(node.value)
            return {name: f".{room}" for room, names in rooms.items() for name in names.split()}
    return {}


def _signature(node: ast.FunctionDef | ast.ClassDef) -> str:
    """``(graph, rows=None, *, seed=0)`` of a function; of a class what its fields or its ``__init__`` take."""
    if isinstance(node, ast.FunctionDef):
        return f"({_parameters(node.args)})"
    for each in node.body:
        if isinstance(each, ast.FunctionDef) and each.name == "__init__":
            return f"({_parameters(each.args).removeprefix('self').removeprefix(', ')})"
    if not any("dataclass" in ast.unparse(each) for each in node.decorator_list):
        return ""
    fields = [each for each in node.body if isinstance(each, ast.AnnAssign)]
    shown = [f"{ast.unparse(each.target)}{'=...' if _optional(each.value) else ''}" for each in fields]
    return f"({', '.join(name for name in shown if not name.startswith('_'))})"


def _parameters(arguments: ast.arguments) -> str:
    """A list of parameters without their types."""
    shown = deepcopy(arguments)
    every = [*shown.posonlyargs, *shown.args, *shown.kwonlyargs, *filter(None, (shown.vararg, shown.kwarg))]
    for each in every:
        each.annotation = None
    return ast.unparse(shown)


def _optional(value: ast.expr | None) -> bool:
    """Whether a dataclass's field may be left out."""
    if isinstance(value, ast.Call) and ast.unparse(value.func) == "field":
        return any(keyword.arg in ("default", "default_factory") for keyword in value.keywords)
    return value is not None


def _first_line(text: str | None) -> str:
    return " ".join((text or "").split("\n\n")[0].split())


def page() -> str:
    """The whole page."""
    parts = [HEAD]
    for package, names in sorted(public_packages().items()):
        about = _first_line(ast.get_docstring(modules()[package].tree))
        found = sorted((describe(package, name) for name in names), key=lambda each: each.name.casefold())
        lines = [f"- `{each.name}{each.signature}` — {each.summary}" for each in found]
        parts.append(f"## {package}\n\n{about}\n\n" + "\n".join(lines) + "\n")
    return "\n".join(parts)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")

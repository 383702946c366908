"""The pages of the site about public names: one for each, with types, its whole docstring and lines that a test runs.

Files are read, not imported, as for docs/api.md; Sphinx's napoleon turns numpy docstrings into reStructuredText.
"""

from __future__ import annotations

import ast
import os
import textwrap
from pathlib import Path

from architecture import ROOT, modules
from sphinx.ext.napoleon import Config, NumpyDocstring
from tested_examples import TestedCode, example, library_example
from write_api_page import definition, describe, public_packages

KINDS = {ast.FunctionDef: "function", ast.ClassDef: "class"}
NAPOLEON = Config(napoleon_use_rtype=False, napoleon_use_ivar=True)
HEAD = """Python API
==========

Every public name has a page: its parameters with types and shapes, and lines that use it, out of code that a test runs.

.. toctree::
   :maxdepth: 1

"""


def write_reference(folder: Path) -> None:
    """Write ``index.rst``, a page for each package, and one for each of its names."""
    packages = sorted(public_packages().items())
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "index.rst").write_text(HEAD + "".join(f"   {package}/index\n" for package, _ in packages), "utf-8")
    for package, names in packages:
        (folder / package).mkdir(exist_ok=True)
        (folder / package / "index.rst").write_text(package_page(package, names), "utf-8")
        for name in names:
            (folder / package / f"{page_name(package, name)}.rst").write_text(name_page(package, name), "utf-8")


def page_name(package: str, name: str) -> str:
    """``function-moment`` and ``class-Moment``: some file systems do not tell capitals apart."""
    return f"{KINDS.get(type(definition(package, name)[0]), 'data')}-{name}"


def package_page(package: str, names: list[str]) -> str:
    """What the package is for, and its names with a line about each."""
    about = (ast.get_docstring(modules()[package].tree) or "").strip()
    found = sorted((describe(package, name) for name in names), key=lambda each: each.name.casefold())
    lines = [f":doc:`{each.name} <{page_name(package, each.name)}>`\n    {each.summary}\n" for each in found]
    return "\n".join([_title(package), about, "", *lines])


def name_page(package: str, name: str) -> str:
    """One public name; in no table of contents, which stands on every page and would grow by hundreds of lines."""
    node, text = definition(package, name)
    parts = [":orphan:\n", _title(name), f".. currentmodule:: {package}", "", _described(node, name, text)]
    if isinstance(node, ast.ClassDef):
        for each in node.body:
            if isinstance(each, ast.FunctionDef) and not each.name.startswith("_"):
                parts.append(textwrap.indent(_described(each, each.name, ast.get_docstring(each) or "", True), "   "))
    found = example(name) or example_of_a_maker(name) or library_example(name)
    return "\n".join(parts) + ("" if found is None else _example(found))


def example_of_a_maker(name: str) -> TestedCode | None:
    """Lines that use a function that gives objects of a class."""
    for package, names in public_packages().items():
        for other in names:
            node, _ = definition(package, other)
            if isinstance(node, ast.ClassDef) and other != name:
                givers = [each for each in node.body if isinstance(each, ast.FunctionDef)]
            else:
                givers = [node] if isinstance(node, ast.FunctionDef) else []
            if any(each.returns is not None and name in _words(each.returns) for each in givers) and example(other):
                return example(other)
    return None


def _words(node: ast.expr) -> set[str]:
    return {each.id for each in ast.walk(node) if isinstance(each, ast.Name)}


def _described(node: ast.stmt, name: str, text: str, member: bool = False) -> str:
    """A directive for a definition, with its docstring below."""
    if isinstance(node, ast.FunctionDef):
        decorators = {ast.unparse(each) for each in node.decorator_list}
        kind = "property" if decorators & {"property", "cached_property"} else "method" if member else "function"
        shown = f"{name}{'' if kind == 'property' else _signature(node, member and 'staticmethod' not in decorators)}"
    else:
        kind, shown = ("class", name + _fields(node)) if isinstance(node, ast.ClassDef) else ("data", name)
    body = str(NumpyDocstring(text, NAPOLEON, what=kind))
    return f".. py:{kind}:: {shown}\n   :no-contents-entry:\n\n" + textwrap.indent(body, "   ") + "\n"


def _signature(node: ast.FunctionDef, bound: bool) -> str:
    arguments = ast.parse(f"def f({ast.unparse(node.args)}): ...").body[0].args  # type: ignore[attr-defined]
    if bound:
        (arguments.posonlyargs or arguments.args).pop(0)
    return f"({ast.unparse(arguments)})" + (f" -> {ast.unparse(node.returns)}" if node.returns else "")


def _fields(node: ast.ClassDef) -> str:
    """What a class takes: the parameters of its ``__init__``, else the fields of a dataclass."""
    for each in node.body:
        if isinstance(each, ast.FunctionDef) and each.name == "__init__":
            return _signature(each, True).partition(" -> ")[0]
    fields = [each for each in node.body if isinstance(each, ast.AnnAssign)]
    shown = [f"{ast.unparse(each.target)}: {ast.unparse(each.annotation)}" for each in fields]
    return f"({', '.join(shown)})" if any("dataclass" in ast.unparse(each) for each in node.decorator_list) else ""


def _example(code: TestedCode) -> str:
    where = os.path.relpath(code.path, ROOT)
    lines = textwrap.indent(code.source.strip("\n"), "   ")
    return f"\n.. rubric:: In use\n\n.. code-block:: python\n   :caption: {where}\n\n{lines}\n"


def _title(text: str) -> str:
    return f"{text}\n{'=' * len(text)}\n"

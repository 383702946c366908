"""The package as a whole: what importing it costs, and how the command line answers."""

from __future__ import annotations

import ast
import subprocess
import sys
import tomllib
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest
from architecture import modules
from write_api_page import PAGE, describe, page, public_packages

import unisg_blender
from unisg_blender import cli
from unisg_blender.errors import MISUSE

ROOT = Path(__file__).parents[1]
HEAVY = ("bpy", "torch", "torch_geometric", "clifford", "onnxruntime", "pytorch_lightning", "scipy", "trimesh")


def run_python(source: str) -> str:
    """What a fresh Python prints."""
    return subprocess.run(
        [sys.executable, "-c", source], capture_output=True, text=True, check=True, timeout=60
    ).stdout.strip()


@pytest.mark.parametrize("module", ["unisg_blender", "unisg_blender.cli", "unisg_blender.scene"])
def test_import_loads_nothing_heavy(module: str) -> None:
    found = run_python(f"import sys, {module}; print([name for name in {HEAVY!r} if name in sys.modules])")
    assert found == "[]"


def test_the_extension_has_the_version_of_the_library() -> None:
    manifest, project = (
        tomllib.loads((ROOT / name).read_text()) for name in ("blender_manifest.toml", "pyproject.toml")
    )
    assert manifest["version"] == unisg_blender.__version__
    assert f"\nversion: {unisg_blender.__version__}\n" in (ROOT / "CITATION.cff").read_text("utf-8")
    assert project["tool"]["setuptools"]["dynamic"]["version"] == {"attr": "unisg_blender.__version__"}


@pytest.mark.parametrize("words", [["bogus"], ["help", "bogus"], ["inspect"], ["inspect", "--bogus", "x"], ["--bogus"]])
def test_misuse_exits_with_2_and_says_so(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(words) == MISUSE
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.parametrize("verb", cli.VERBS)
def test_every_verb_has_help(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main([verb, "--help"]) == 0
    shown = capsys.readouterr().out
    assert f"usage: unisg {verb}" in shown
    assert "--json" in shown


@pytest.mark.parametrize(
    ("words", "same"), [([], ["--help"]), (["help"], ["--help"]), (["help", "web"], ["web", "-h"])]
)
def test_whoever_asks_for_help_gets_it(words: list[str], same: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    told = [(cli.main(asked), capsys.readouterr().out) for asked in (words, same)]
    assert told[0] == told[1]
    assert told[0][0] == 0


def test_three_doors_are_one(capfd: pytest.CaptureFixture[str]) -> None:
    cli.main(["--help"])
    direct = capfd.readouterr().out
    module = subprocess.run(
        [sys.executable, "-m", "unisg_blender", "--help"], capture_output=True, text=True, timeout=60
    ).stdout
    assert module == direct


PACKAGES = public_packages()


def opened(package: str) -> ModuleType:
    """A package; skips where something that it needs is not installed."""
    try:
        return import_module(package)
    except unisg_blender.UniSGError as error:
        pytest.skip(str(error))


@pytest.mark.parametrize("package", PACKAGES)
def test_public_names_are_there_described_and_no_modules(package: str) -> None:
    """A name that is also that of a module beside it could mean either."""
    module = opened(package)
    beside = {name.rpartition(".")[2] for name in modules() if name.rpartition(".")[0] == package}
    assert set(PACKAGES[package]) & beside == set()
    assert set(PACKAGES[package]) <= set(dir(module))
    for name in PACKAGES[package]:
        assert hasattr(module, name)
        assert not isinstance(getattr(module, name), ModuleType)
        assert describe(package, name).summary, f"{package}.{name} has no docstring"


def test_every_room_says_what_is_public() -> None:
    rooms = {module.name for module in modules().values() if module.is_package and module.name.count(".") == 1}
    inner = {f"unisg_blender.{name}" for name in ("commands", "experiments", "runtime")}
    assert {name for name in rooms if name.startswith("unisg_blender")} - inner <= set(PACKAGES)


def test_the_page_of_public_names_is_current() -> None:
    assert PAGE.read_text("utf-8") == page(), "make docs"


def test_type_checkers_see_the_same_names() -> None:
    stub = ast.parse((Path(unisg_blender.__path__[0]) / "__init__.pyi").read_text("utf-8"))
    listed = next(node for node in stub.body if isinstance(node, ast.Assign))
    imported = {alias.name for node in stub.body if isinstance(node, ast.ImportFrom) for alias in node.names}
    assert set(ast.literal_eval(listed.value)) == set(unisg_blender.__all__) == imported | {"__version__"}


def test_names_are_imported_when_they_are_first_asked_for() -> None:
    found = run_python(
        "import sys, unisg_blender as u; before = 'unisg_blender.scene' in sys.modules; u.SceneGraph; "
        "print(before, 'unisg_blender.scene' in sys.modules, 'SceneGraph' in vars(u))"
    )
    assert found == "False True True"
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        unisg_blender.nothing  # type: ignore[attr-defined]  # noqa: B018

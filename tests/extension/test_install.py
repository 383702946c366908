"""The extension as a user gets it: built, installed from the zip in a fresh profile, used, removed."""

from __future__ import annotations

import ast
import json
import os
import platform
import subprocess
import sys
import tomllib
import zipfile
from importlib import metadata
from pathlib import Path

import pytest
from build_extension import VERSIONS
from extension_wheels import CONSTRAINTS, LOCK, PLATFORMS, PYTHONS, SHIPPED, pins

ROOT = Path(__file__).resolve().parents[2]
TIME_LIMIT = 280
PYTHON = f"{sys.version_info.major}.{sys.version_info.minor}"
MOST_MEGABYTES = 100

INSTALL = """
import json, sys, time
import bpy, addon_utils
zip_file, name = sys.argv[1], "bl_ext.user_default.unisg_blender"
bpy.ops.extensions.package_install_files(filepath=zip_file, repo="user_default", enable_on_install=True)
heavy = [module for module in ("onnxruntime", "torch", "clifford", "scipy", "trimesh") if module in sys.modules]
cube = bpy.data.objects["Cube"]
cube.select_set(True)
bpy.ops.unisg.assign_category(category="Box")
print("RESULT" + json.dumps({
    "enabled": name in bpy.context.preferences.addons.keys(),
    "heavy": heavy,
    "category": cube["unisg_category"],
    "tabs": sorted({getattr(bpy.types, name).bl_category for name in dir(bpy.types) if name.startswith("UNISG_PT")}),
}))
addon_utils.disable(name)
print("LEFT" + json.dumps([name for name in dir(bpy.types) if name.startswith("UNISG_")]))
"""


@pytest.fixture(scope="module")
def extension_zip(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The zip for Linux, built by the project's own command unless ``make extension`` has just built it."""
    if platform.system() != "Linux" or platform.machine() != "x86_64":
        pytest.skip("the wheels in the zip that this test installs are those of Linux on x86-64")
    out = tmp_path_factory.mktemp("extension")
    command = [sys.executable, "packaging/build_extension.py", "--platform", "linux-x64", "--python", PYTHON]
    command += ["--out", str(out)]
    subprocess.run(command, cwd=ROOT, check=True, timeout=TIME_LIMIT, capture_output=True)
    return next(out.glob("*.zip"))


@pytest.mark.slow
def test_installs_from_the_zip_and_leaves_nothing_behind(extension_zip: Path, tmp_path: Path) -> None:
    script = tmp_path / "install.py"
    script.write_text(INSTALL)
    run = subprocess.run(
        [sys.executable, str(script), str(extension_zip)],
        env=dict(os.environ, BLENDER_USER_RESOURCES=str(tmp_path / "user")),
        capture_output=True,
        text=True,
        timeout=TIME_LIMIT,
    )
    lines = run.stdout.splitlines()
    result = json.loads(next(line for line in lines if line.startswith("RESULT")).removeprefix("RESULT"))
    assert result["enabled"]
    assert result["heavy"] == []
    assert result["category"] == "Box"
    assert result["tabs"] == ["UniSG"]
    unpacked = {path.name for path in (tmp_path / "user/extensions/.local/lib").glob("python3.*/site-packages/*")}
    assert {"onnxruntime", "safetensors", "trimesh", "scipy", "tqdm"} <= unpacked
    assert "numpy" not in unpacked
    assert "LEFT[]" in lines
    assert run.returncode == 0


@pytest.mark.slow
def test_the_zip_has_what_it_needs_and_nothing_else(extension_zip: Path) -> None:
    with zipfile.ZipFile(extension_zip) as archive:
        names = archive.namelist()
        manifest = tomllib.loads(archive.read("blender_manifest.toml").decode())
    assert {"__init__.py", "LICENSE", "LICENSE-GPL-3.0.txt"} <= set(names)
    wheels = {tuple(Path(name).name.split("-")[:2]) for name in names if name.endswith(".whl")}
    assert wheels == set(pins(LOCK).items())
    compiled = {Path(name).name.split("-")[2] for name in names if "/onnxruntime-" in name or "/scipy-" in name}
    assert compiled == {f"cp{PYTHON.replace('.', '')}"}
    assert (manifest["blender_version_min"], manifest.get("blender_version_max")) == VERSIONS[PYTHON]
    assert not [name for name in names if "__pycache__" in name or name.startswith(("tests/", "docs/", "."))]
    assert extension_zip.stat().st_size < MOST_MEGABYTES * 1e6


def test_what_is_shipped_is_what_is_tested() -> None:
    shipped, tested = pins(LOCK), pins(CONSTRAINTS)
    assert set(shipped) == set(SHIPPED)
    assert shipped == {name: tested[name] for name in SHIPPED} == {name: metadata.version(name) for name in SHIPPED}


def test_every_wheel_has_a_hash_for_each_platform() -> None:
    text = LOCK.read_text("utf-8").replace(" \\\n", "")
    hashes = {line.partition("==")[0]: line.count("--hash=sha256:") for line in text.splitlines() if "==" in line}
    platforms, pythons = len(PLATFORMS), len(PYTHONS)
    of_one, of_all = dict.fromkeys(("onnxruntime", "scipy"), platforms * pythons), dict.fromkeys(SHIPPED, 1)
    assert hashes == of_all | dict.fromkeys(("protobuf", "safetensors"), platforms) | of_one


NETWORK = {"aiohttp", "ftplib", "http", "httpx", "requests", "smtplib", "socket", "ssl", "urllib.request", "webbrowser"}


def imports_and_attributes(file: Path) -> tuple[set[str], set[str]]:
    """What a file of the extension imports by absolute names, and the names that follow a dot in it."""
    nodes = list(ast.walk(ast.parse(file.read_text("utf-8"))))
    imports = {alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
    for node in nodes:
        if isinstance(node, ast.ImportFrom) and node.module and not node.level:
            imports |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return imports, {node.attr for node in nodes if isinstance(node, ast.Attribute)}


@pytest.mark.slow
def test_permissions_are_those_that_the_code_needs() -> None:
    manifest = tomllib.loads((ROOT / "blender_manifest.toml").read_text("utf-8"))
    files = [ROOT / "__init__.py"]
    files += [file for part in ("operators", "panels", "unisg_blender") for file in (ROOT / part).rglob("*.py")]
    found = [imports_and_attributes(file) for file in files]
    imports, attributes = (set().union(*sets) for sets in zip(*found, strict=True))
    needed = {
        "files": bool(attributes & {"open", "read_bytes", "write_text", "write_bytes"}),
        "clipboard": "clipboard" in attributes,
        "network": bool(imports & NETWORK),
    }
    assert set(manifest["permissions"]) == {name for name, wanted in needed.items() if wanted}

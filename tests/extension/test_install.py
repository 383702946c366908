"""The extension as a user gets it: built, installed from the zip in a fresh profile, used, removed."""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TIME_LIMIT = 280

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
    command = [sys.executable, "packaging/build_extension.py", "--platform", "linux-x64", "--out", str(out)]
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
    import zipfile

    names = zipfile.ZipFile(extension_zip).namelist()
    assert "blender_manifest.toml" in names
    assert "__init__.py" in names
    wheels = {Path(name).name.split("-")[0] for name in names if name.endswith(".whl")}
    assert {"onnxruntime", "protobuf", "flatbuffers", "packaging", "safetensors", "trimesh", "scipy"} <= wheels
    assert not wheels & {"numpy", "torch", "clifford"}
    pythons = {Path(name).name.split("-")[2] for name in names if Path(name).name.startswith("onnxruntime")}
    assert pythons == {"cp311", "cp313"}
    assert not [name for name in names if "__pycache__" in name or name.startswith(("tests/", "docs/", "."))]

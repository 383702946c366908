"""Run the tests of what touches Blender and of what infers on what is shipped: the zip's code with exactly its wheels.

    python packaging/check_zip.py [--zips build/extension] [--python 3.11] [pytest's words]

For each Python the Linux zip is unpacked, tests are laid beside its code, and an environment gets the zip's wheels
and no others of theirs, Blender's module and pytest. Neither torch nor this repository's own code is there.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

from build_extension import VERSIONS
from extension_wheels import ROOT

BLENDERS = {"3.11": "4.5.15", "3.13": "5.2.3"}
ROOMS = ("blender", "extension", "formats", "generate", "meshes", "operators", "panels", "predict", "runtime", "usd")
BESIDE = ("tests", "packaging", "docs", "pyproject.toml", "constraints.txt")
TOOLS = ("pytest", "pytest-timeout", "pytest-xdist", "hypothesis")
INSTALL_LIMIT, TEST_LIMIT = 900, 1800


def answers(python: str) -> bool:
    """Whether a Python of this version can be started."""
    found = shutil.which(python)
    return found is not None and subprocess.run([found, "--version"], capture_output=True, timeout=60).returncode == 0


def unpack(zipped: Path, folder: Path) -> list[Path]:
    """Lay out a zip's files and the tests beside them; returns its wheels."""
    shutil.rmtree(folder, ignore_errors=True)
    with zipfile.ZipFile(zipped) as archive:
        archive.extractall(folder)
    for name in BESIDE:
        (folder / name).symlink_to(ROOT / name)
    return sorted((folder / "wheels").glob("*.whl"))


def install(python: str, wheels: list[Path], environment: Path) -> Path:
    """Make the environment; returns its Python."""
    if not (environment / "bin/python").exists():
        subprocess.run([f"python{python}", "-m", "venv", str(environment)], check=True, timeout=INSTALL_LIMIT)
    own = environment / "bin/python"
    pip = [str(own), "-m", "pip", "install", "--quiet"]
    subprocess.run([*pip, "--no-index", "--no-deps", *map(str, wheels)], check=True, timeout=INSTALL_LIMIT)
    exact = environment / "constraints.txt"
    numpy = re.findall("^numpy.*$", (ROOT / "constraints.txt").read_text("utf-8"), re.MULTILINE)
    exact.write_text("\n".join(numpy + [f"{name}=={version}" for name, version in map(named, wheels)]))
    words = ["--constraint", str(exact), f"bpy=={BLENDERS[python]}", *TOOLS]
    subprocess.run([*pip, *words], check=True, timeout=INSTALL_LIMIT)
    subprocess.run([*pip[:3], "check"], check=True, timeout=INSTALL_LIMIT)
    return own


def named(wheel: Path) -> tuple[str, str]:
    """Name and version in a wheel's file name."""
    name, version, *_ = wheel.name.split("-")
    return name, version


def keep_models(folder: Path) -> None:
    """Train the tests' small models, which takes torch, for use where there is none."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    command = [sys.executable, "-c", "from tests.generate.models import keep; keep()"]
    env = os.environ | {"PYTHONPATH": str(ROOT), "UNISG_TEST_MODELS": str(folder)}
    subprocess.run(command, cwd=ROOT, env=env, check=True, timeout=INSTALL_LIMIT)


def main() -> int:
    """Test every Python that is there; 1 if a test fails."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--zips", type=Path, default=ROOT / "build/extension", help="folder of the zips")
    parser.add_argument("--python", action="append", choices=VERSIONS, help="only this one (may be repeated)")
    args, words = parser.parse_known_args()
    models = ROOT / "build/test-zip/models"
    keep_models(models)
    failed = False
    os.environ.pop("PYTHONPATH", None)  # what is found there would count as installed
    for python in args.python or VERSIONS:
        os.environ["PYENV_VERSION"] = python  # pyenv hides every Python but the one that is asked for
        if not answers(f"python{python}"):
            print(f"python{python} is not installed: its zip is not tested")
            continue
        first = VERSIONS[python][0].removesuffix(".0")
        (zipped,) = args.zips.glob(f"*linux_x64-blender{first}.zip")
        folder = ROOT / "build/test-zip" / python
        wheels = unpack(zipped, folder / "extension")
        own = install(python, wheels, folder / "environment")
        print(f"{zipped.name} on bpy {BLENDERS[python]}, Python {python}:", *("==".join(named(it)) for it in wheels))
        where = [f"tests/{room}" for room in ROOMS] if not any(word.startswith("tests/") for word in words) else []
        run = subprocess.run(
            [str(own), "-m", "pytest", "-n", "2", "--dist", "loadfile", *where, *words],
            cwd=folder / "extension",
            env=os.environ | {"PYTHONPATH": str(folder / "extension"), "UNISG_TEST_MODELS": str(models)},
            timeout=TEST_LIMIT,
        )
        failed |= run.returncode != 0
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())

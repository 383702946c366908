"""Build the extension's zips, one per platform and Python, with Blender's own builder, and validate them.

    python packaging/build_extension.py [--platform linux-x64] [--python 3.11] [--blender 4.3.0] [--out build/extension]

Needs the ``bpy`` package for Blender's builder (its files only: Blender is not started) and pip for the wheels. A zip
has the wheels of one Python: onnxruntime and scipy are nearly all of its weight, and Blender has one Python. Linux
distributions build Blender with a Python of their own: ``--python 3.13 --blender 4.3.0`` is for Debian 13's Blender.
"""

from __future__ import annotations

import argparse
import importlib.util
import shutil
import subprocess
import sys
from pathlib import Path

from extension_wheels import LOCK, PLATFORMS, PYTHONS, ROOT, TIME_LIMIT, download

PARTS = ("__init__.py", "operators", "panels", "unisg_blender", "LICENSE", "LICENSE-GPL-3.0.txt", "README.md")
VERSIONS = {"3.11": ("4.2.0", "5.1.0"), "3.13": ("5.1.0", None)}
"""For each Python the first Blender that has it, and the first that no longer has."""


def blender_builder() -> Path:
    """The script ``blender_ext.py`` inside the bpy package."""
    spec = importlib.util.find_spec("bpy")
    for place in (spec.submodule_search_locations or ()) if spec else ():
        for found in Path(place).glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py"):
            return found
    sys.exit("Blender's extension builder was not found: pip install bpy==4.5.15")


def stage(platforms: list[str], python: str, blender: tuple[str, str | None], source: Path) -> None:
    """Lay out the extension's files and its wheels."""
    shutil.rmtree(source, ignore_errors=True)
    source.mkdir(parents=True)
    for part in PARTS:
        if (ROOT / part).is_dir():
            shutil.copytree(ROOT / part, source / part, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(ROOT / part, source / part)
    for platform in platforms:
        download(LOCK, platform, python, source / "wheels")
    wheels = [f"./wheels/{wheel.name}" for wheel in sorted((source / "wheels").glob("*.whl"))]
    (source / "blender_manifest.toml").write_text(manifest(platforms, blender, wheels), "utf-8")


def manifest(platforms: list[str], blender: tuple[str, str | None], wheels: list[str]) -> str:
    """The text of the manifest for some platforms and versions of Blender: from the first to before the last."""
    first, end = blender
    text = (ROOT / "blender_manifest.toml").read_text("utf-8")
    limits = f'blender_version_min = "{first}"' + (f'\nblender_version_max = "{end}"' if end else "")
    for old, new in (
        ('blender_version_min = "4.2.0"', limits),
        ('platforms = ["linux-x64", "windows-x64", "macos-arm64"]', f"platforms = {quoted(platforms)}"),
        ("wheels = []", f"wheels = {quoted(wheels)}"),
    ):
        if text.count(old) != 1:
            sys.exit(f"blender_manifest.toml: expected once: {old}")
        text = text.replace(old, new)
    return text


def quoted(words: list[str]) -> str:
    """A list as TOML writes it."""
    return "[" + ", ".join(f'"{word}"' for word in words) + "]"


def build(platforms: list[str], python: str, blender: tuple[str, str | None], out: Path) -> list[Path]:
    """Build and validate the zips for one Python; their names end with the first Blender that takes them."""
    builder, source, fresh = blender_builder(), out / "source", out / "fresh"
    stage(platforms, python, blender, source)
    fresh.mkdir(exist_ok=True)
    words = ["build", "--split-platforms", "--source-dir", str(source), "--output-dir", str(fresh)]
    subprocess.run([sys.executable, str(builder), *words], check=True, timeout=TIME_LIMIT)
    first = blender[0].removesuffix(".0")
    zips = [zipped.rename(out / f"{zipped.stem}-blender{first}.zip") for zipped in sorted(fresh.glob("*.zip"))]
    fresh.rmdir()
    for zipped in zips:
        subprocess.run([sys.executable, str(builder), "validate", str(zipped)], check=True, timeout=TIME_LIMIT)
    return zips


def main() -> None:
    """Build and validate; prints the zips with their sizes."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--platform", action="append", choices=PLATFORMS, help="only this one (may be repeated)")
    parser.add_argument("--python", action="append", choices=PYTHONS, help="only this one (may be repeated)")
    parser.add_argument("--blender", help="the first version that takes the zips (default: the first with that Python)")
    parser.add_argument("--out", type=Path, default=ROOT / "build/extension", help="folder for the zips")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    for old in args.out.glob("*.zip"):
        old.unlink()
    for python in args.python or PYTHONS:
        blender = (args.blender, None) if args.blender else VERSIONS[python]
        for zipped in build(args.platform or list(PLATFORMS), python, blender, args.out):
            print(f"{zipped}  {zipped.stat().st_size / 1e6:.0f} MB")


if __name__ == "__main__":
    main()

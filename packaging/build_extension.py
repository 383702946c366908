"""Build the extension's zips, one per platform, with Blender's own builder, and validate them.

    python packaging/build_extension.py [--platform linux-x64] [--out build/extension]

Needs the ``bpy`` package for Blender's builder (its files only: Blender is not
started) and pip for the wheels.
"""

from __future__ import annotations

import argparse
import importlib.util
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PARTS = ("__init__.py", "operators", "panels", "unisg_blender", "LICENSE", "README.md")
PYTHONS = ("3.11", "3.13")
PLATFORMS = {
    "linux-x64": ("manylinux_2_28_x86_64", "manylinux_2_27_x86_64", "manylinux_2_17_x86_64", "manylinux2014_x86_64"),
    "windows-x64": ("win_amd64",),
    "macos-arm64": ("macosx_13_0_arm64", "macosx_12_0_arm64", "macosx_11_0_arm64", "macosx_10_9_universal2"),
}
TIME_LIMIT = 600


def blender_builder() -> Path:
    """The script ``blender_ext.py`` inside the bpy package."""
    spec = importlib.util.find_spec("bpy")
    for place in (spec.submodule_search_locations or ()) if spec else ():
        for found in Path(place).glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py"):
            return found
    sys.exit("Blender's extension builder was not found: pip install bpy==4.5.15")


def download_wheels(platform: str, folder: Path) -> None:
    """Fetch the wheels of one platform for every Python that Blender has."""
    tags = [word for tag in PLATFORMS[platform] for word in ("--platform", tag)]
    for python in PYTHONS:
        command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--only-binary=:all:"]
        command += ["--dest", str(folder), "--implementation", "cp", "--python-version", python, *tags]
        subprocess.run([*command, "--requirement", str(ROOT / "packaging/wheels.txt")], check=True, timeout=TIME_LIMIT)


def stage(platforms: list[str], source: Path) -> None:
    """Lay out the extension's files, its wheels, and a manifest that lists them."""
    shutil.rmtree(source, ignore_errors=True)
    source.mkdir(parents=True)
    ignore = shutil.ignore_patterns("__pycache__")
    for part in PARTS:
        copy = shutil.copytree if (ROOT / part).is_dir() else shutil.copy
        copy(ROOT / part, source / part, **({"ignore": ignore} if copy is shutil.copytree else {}))
    cache = source.parent / "wheels"
    wanted: set[Path] = set()
    for platform in platforms:
        folder = cache / platform
        folder.mkdir(parents=True, exist_ok=True)
        download_wheels(platform, folder)
        wanted |= set(folder.glob("*.whl"))
    (source / "wheels").mkdir()
    for wheel in wanted:
        shutil.copy(wheel, source / "wheels" / wheel.name)
    lines = "".join(f'  "./wheels/{name}",\n' for name in sorted({wheel.name for wheel in wanted}))
    manifest = (ROOT / "blender_manifest.toml").read_text()
    manifest = manifest.replace("wheels = []", f"wheels = [\n{lines}]")
    quoted = ", ".join(f'"{platform}"' for platform in platforms)
    manifest = manifest.replace('platforms = ["linux-x64", "windows-x64", "macos-arm64"]', f"platforms = [{quoted}]")
    (source / "blender_manifest.toml").write_text(manifest)


def main() -> None:
    """Build and validate; prints the zips with their sizes."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--platform", action="append", choices=PLATFORMS, help="only this one (may be repeated)")
    parser.add_argument("--out", type=Path, default=ROOT / "build/extension", help="folder for the zips")
    args = parser.parse_args()
    builder, source = blender_builder(), args.out / "source"
    stage(args.platform or list(PLATFORMS), source)
    for old in args.out.glob("*.zip"):
        old.unlink()
    build = ["build", "--split-platforms", "--source-dir", str(source), "--output-dir", str(args.out)]
    subprocess.run([sys.executable, str(builder), *build], check=True, timeout=TIME_LIMIT)
    zips = sorted(args.out.glob("*.zip"))
    for zipped in zips:
        subprocess.run([sys.executable, str(builder), "validate", str(zipped)], check=True, timeout=TIME_LIMIT)
        print(f"{zipped}  {zipped.stat().st_size / 1e6:.0f} MB")


if __name__ == "__main__":
    main()

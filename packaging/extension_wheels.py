"""The wheels that the extension brings along, because Blender has none of them. numpy is Blender's own.

    python packaging/extension_wheels.py

asks the package index for the wheels of every platform and Python, in the versions of ``constraints.txt`` (what
the tests run with), and writes them with their hashes to ``packaging/wheels.txt``, from which the zips are built.
"""

from __future__ import annotations

import hashlib
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CONSTRAINTS = ROOT / "constraints.txt"
LOCK = ROOT / "packaging" / "wheels.txt"
SHIPPED = ("flatbuffers", "onnxruntime", "packaging", "protobuf", "safetensors", "scipy", "tqdm", "trimesh")
PYTHONS = ("3.11", "3.13")
PLATFORMS = {
    "linux-x64": [f"manylinux_2_{minor}_x86_64" for minor in (28, 27, 17)] + ["manylinux2014_x86_64"],
    "windows-x64": ["win_amd64"],
    "macos-arm64": [f"macosx_{major}_0_arm64" for major in (14, 13, 12, 11)] + ["macosx_10_9_universal2"],
}
PIN = re.compile(r"^([\w-]+)==([\w.]+)", re.MULTILINE)
TIME_LIMIT = 600


def pins(file: Path) -> dict[str, str]:
    """Names and exact versions that a file of requirements or constraints sets."""
    return dict(PIN.findall(file.read_text("utf-8")))


def download(requirements: Path, platform: str, python: str, folder: Path) -> None:
    """Fetch the wheels of one platform and Python; pip holds them against the hashes, where there are any."""
    command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--only-binary=:all:"]
    command += ["--dest", str(folder), "--implementation", "cp", "--python-version", python]
    command += [word for tag in PLATFORMS[platform] for word in ("--platform", tag)]
    subprocess.run([*command, "--requirement", str(requirements)], check=True, timeout=TIME_LIMIT)


def lock() -> str:
    """The text of ``wheels.txt``: each package with its version and the hashes of its wheels."""
    versions = pins(CONSTRAINTS)
    hashes: dict[str, set[str]] = {name: set() for name in SHIPPED}
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        wanted = folder / "wanted.txt"
        wanted.write_text("".join(f"{name}=={versions[name]}\n" for name in SHIPPED))
        for platform in PLATFORMS:
            for python in PYTHONS:
                download(wanted, platform, python, folder)
        for wheel in folder.glob("*.whl"):
            hashes[wheel.name.partition("-")[0]].add(hashlib.sha256(wheel.read_bytes()).hexdigest())
    text = "# Written by packaging/extension_wheels.py; the versions are those of constraints.txt.\n"
    for name in SHIPPED:
        text += " \\\n".join([f"{name}=={versions[name]}", *(f"    --hash=sha256:{it}" for it in sorted(hashes[name]))])
        text += "\n"
    return text


if __name__ == "__main__":
    LOCK.write_text(lock(), "utf-8")

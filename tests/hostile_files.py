"""Damaged scene files by seed, and a process that reads them: each gives a scene or one UniSGError.

``python -m tests.hostile_files FILE...`` reads files one after the other and prints what came of each.
"""

from __future__ import annotations

import io
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import traceback
import zipfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

LIMIT = 10
"""Seconds that one file may take."""
GUARDED = "guarded, "
"""Starts the outcome of a file over which Blender or USD crash or hang, which the command line tells."""
UNFORESEEN = "refused: unforeseen, "
"""Starts the outcome of a file that some part of the reading stumbled over."""
TEXT = ("usda", "gltf", "json")
OF_A_CRASH = ("blender_", "st_python")
"""Starts of what Blender and USD leave of a process that crashed; where the command line reads, it is removed."""
NUMBERS = (
    "0", "-1", "nan", "inf", "-inf", "1e308", "-1e308", "1e-308", "2147483648", "-2147483649", "99999999999", "1e39",
    "9" * 400, '"x"', "[]", "{}", "null", "true",
)  # fmt: skip
NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
WORDS = re.compile(rb'-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?|"[^"\n]*"|[A-Za-z_:]+|[\[\](){}<>,=]')
MAKE = """
import sys
from pathlib import Path
import bpy
from unisg_blender.formats import write_scene_file
from unisg_blender.worlds import WORLDS
folder = Path(sys.argv[1])
graph = WORLDS["living-room"](3)
for ending in ("usda", "usdc", "usdz", "json", "blend"):
    write_scene_file(graph, folder / f"sound.{ending}")
bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
for ending, form in (("glb", "GLB"), ("gltf", "GLTF_SEPARATE")):
    bpy.ops.export_scene.gltf(filepath=str(folder / f"sound.{ending}"), export_format=form)
"""


def make_sound_files(folder: Path) -> None:
    """One small scene in every kind of file, ``sound.*``."""
    subprocess.run([sys.executable, "-c", MAKE, str(folder)], check=True, capture_output=True, timeout=120)


def damaged(data: bytes, kind: str, rng: np.random.Generator) -> bytes:
    """The bytes of a file with one to three damages, of a package mostly within what it packs."""
    if kind == "usdz" and rng.random() < 0.9:
        return _repacked(data, rng)
    for _ in range(int(rng.integers(1, 4))):
        data = _word_damage(data, rng) if kind in TEXT and rng.random() < 0.9 else _byte_damage(data, rng)
    return data


def _repacked(package: bytes, rng: np.random.Generator) -> bytes:
    """A package whose layer is damaged, but whose checksums are right, so that USD opens it."""
    new = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(package)) as old, zipfile.ZipFile(new, "w", zipfile.ZIP_STORED) as packed:
        for name in old.namelist():
            packed.writestr(zipfile.ZipInfo(name), damaged(old.read(name), Path(name).suffix[1:], rng))
    return new.getvalue()


def _word_damage(data: bytes, rng: np.random.Generator) -> bytes:
    """A word taken out, doubled, or replaced: half of the time by what the grammar allows as well."""
    words = list(WORDS.finditer(data))
    if not words:
        return data
    found = words[int(rng.integers(len(words)))]
    number = NUMBERS[int(rng.integers(len(NUMBERS)))].encode()
    if rng.random() < 0.5:
        is_number = NUMBER.fullmatch(found[0])
        alike = [word[0] for word in words if word[0][:1] == found[0][:1]]
        new = number if is_number and rng.random() < 0.7 else alike[int(rng.integers(len(alike)))]
    else:
        other = words[int(rng.integers(len(words)))][0]
        new = (b"", found[0] * 2, number, other)[int(rng.integers(4))]
    return data[: found.start()] + new + data[found.end() :]


def _byte_damage(data: bytes, rng: np.random.Generator) -> bytes:
    """Bytes flipped, taken out, or the end cut off."""
    if len(data) < 2:
        return data
    place, kind = int(rng.integers(len(data))), int(rng.integers(4))
    if kind == 0:
        return data[:place]
    if kind == 1:
        return data[:place] + data[place + int(rng.integers(1, 200)) :]
    length = int(rng.integers(1, 9))
    return data[:place] + rng.bytes(length) + data[place + length :]


def outcomes(files: Sequence[Path]) -> dict[Path, str]:
    """What comes of reading each file in other processes: "scene", "refused: ...", or what should not be.

    A file over which such a process ends is read again by the command line, whose guard answers for it.
    """
    found: dict[Path, str] = {}
    with tempfile.TemporaryDirectory() as scratch:
        while waiting := [file for file in files if file not in found]:
            command = [sys.executable, "-m", "tests.hostile_files", *map(str, waiting)]
            environment = os.environ | {"TMPDIR": scratch}
            done = subprocess.run(
                command, capture_output=True, text=True, errors="replace", env=environment, check=False
            )
            told = [json.loads(line) for line in done.stdout.splitlines() if line.startswith('["')]
            found |= {Path(name): outcome for name, outcome in told}
            if len(told) < len(waiting):
                found[waiting[len(told)]] = guarded_outcome(waiting[len(told)])
        left = sorted(path.name for path in Path(scratch).iterdir() if not path.name.startswith(OF_A_CRASH))
    return found | ({Path("leftovers"): f"left behind: {left}"} if left else {})


def guarded_outcome(file: Path) -> str:
    """What comes of a file that crashed a process, or did not end, where the command line reads it."""
    with tempfile.TemporaryDirectory() as out, tempfile.TemporaryDirectory() as scratch:
        command = [sys.executable, "-m", "unisg_blender", "convert", str(file), str(Path(out, "again.json")), "-q"]
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, errors="replace", env=os.environ | {"TMPDIR": scratch},
                timeout=6 * LIMIT, check=False,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            return "hang"
        left = sorted(path.name for folder in (out, scratch) for path in Path(folder).iterdir())
    lines = done.stderr.splitlines()
    if done.returncode == 0 and left == ["again.json"]:
        return "scene"
    if done.returncode != 1 or done.stdout or len(lines) != 1 or left:
        return f"status {done.returncode}, {lines}, left behind: {left}"
    return f"{GUARDED if 'crashed with' in lines[0] or 'nothing came' in lines[0] else ''}refused: {lines[0]}"


def is_fault(outcome: str) -> bool:
    """Whether that should not come of a file."""
    return outcome != "scene" and not outcome.removeprefix(GUARDED).startswith("refused: ")


def read_one(file: Path) -> str:
    """Read a file, and write what was read as JSON and USD."""
    from unisg_blender.errors import UniSGError
    from unisg_blender.formats.scene_files import read_scene_file, write_scene_file

    try:
        graph, _ = read_scene_file(file, animation=True)
        with tempfile.TemporaryDirectory() as folder:
            for ending in ("json", "usdc"):
                write_scene_file(graph, Path(folder, f"again.{ending}"))
    except UniSGError as error:
        lines = str(error).splitlines()
        known = "refused: " if error.__cause__ is None else UNFORESEEN
        return f"{known}{error}" if len(lines) == 1 else f"several lines: {lines}"
    except Exception:
        return traceback.format_exc()
    return "scene"


def main() -> None:
    """Read the files that the command line names, in the order given."""
    from unisg_blender.formats.scene_files import load_blender

    load_blender()
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    for name in sys.argv[1:]:
        signal.alarm(LIMIT)
        print(json.dumps([name, read_one(Path(name))]), flush=True)
    os._exit(0)


if __name__ == "__main__":
    main()

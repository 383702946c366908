"""Nonsense command lines for :mod:`.fuzz`."""

from __future__ import annotations

import argparse
import contextlib
import importlib
import io
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np

from unisg_blender import cli
from unisg_blender.errors import UniSGError
from unisg_blender.formats.scene_files import write_scene_file
from unisg_blender.worlds import cubes

Case = Callable[[], object]

TEXTS = (
    "", " ", "-", "--", "-1", "0", "1", "nan", "inf", "-inf", "1e999", "9" * 5000, "0x10", "x" * 300, "x\ny", "\udcff",
    "../..", "/dev", "/dev/null", "/dev/zero", "/proc/self/mem", "*", "**", "[", "a=1,b", "Cup=2", "Cup=-1", "=", "💥",
)  # fmt: skip
HEAVY = ("demo", "benchmark", "train", "evaluate", "world")
"""Verbs whose work takes long: their lines have a number that is always refused."""


def prepare(folder: Path) -> Callable[[np.random.Generator], Case]:
    """Lines of all verbs with files of many kinds, options and words in any place."""
    folder = folder / "inner" / "most"  # so that "../.." is not the whole machine
    folder.mkdir(parents=True)
    write_scene_file(cubes(0), folder / "scene.json")
    (folder / "folder").mkdir()
    (folder / "empty.json").touch()
    (folder / "deep.json").write_text("[" * 5000)
    (folder / "deep.toml").write_text("a = " + "[" * 5000)
    (folder / "text.usda").write_text("no usd")
    (folder / "binary.onnx").write_bytes(bytes(range(256)) * 10)
    (folder / "types.py").write_text("CONDITIONS = 3\n")
    (folder / "loop.json").symlink_to("loop.json")
    if hasattr(os, "mkfifo"):
        for name in ("pipe.json", "pipe.onnx", "pipe.usda", "pipe.safetensors"):
            os.mkfifo(folder / name)
    files = [str(path) for path in folder.iterdir()] + [str(folder / name) for name in ("no.json", "no/no.usda", "new")]
    words = [*TEXTS, *files, str(folder / "scene.json"), str(folder / "scene.json")]

    def make(rng: np.random.Generator) -> Case:
        line = _line(rng, words)

        def case() -> None:
            errors = io.StringIO()
            with contextlib.redirect_stderr(errors), contextlib.chdir(folder):
                status = cli.main(line)
            told = [text for text in errors.getvalue().split("\n") if text]
            if status not in (0, 1, 2, 3) or (status in (1, 2) and len(told) != 1):
                raise AssertionError(f"{line[:1]}: status {status}, {len(told)} lines: {told[:1]}"[:300])
            if status in (1, 2):
                raise UniSGError(told[0][:900])

        return case

    return make


def _line(rng: np.random.Generator, words: list[str]) -> list[str]:
    verb = str(rng.choice(list(cli.VERBS)))
    parser = argparse.ArgumentParser(add_help=False)
    importlib.import_module(f"unisg_blender.commands.{verb}").add_arguments(parser)
    line = [verb, "-q"]
    for action in parser._actions:
        positional = not action.option_strings
        if not positional and rng.random() > (0.9 if action.required else 0.25):
            continue
        option = [] if positional else [str(rng.choice(action.option_strings))]
        many = int(rng.integers(0, 3)) if action.nargs in ("+", "*") else int(action.nargs != 0)
        line += option + [_word(rng, action, words) for _ in range(many)]
    if verb in HEAVY:
        line += ["--seed", "-1"]
    if rng.random() < 0.1:
        line.insert(int(rng.integers(len(line))), words[rng.integers(len(words))])
    return line


def _word(rng: np.random.Generator, action: argparse.Action, words: list[str]) -> str:
    if action.choices and rng.random() < 0.8:
        return str(rng.choice(list(action.choices)))
    if (action.type is Path or action.dest == "inputs") and rng.random() < 0.4:
        return "scene.json"
    if action.type is not None and action.type is not Path and rng.random() < 0.5:
        return str(rng.choice(["1", "2", "0.5"]))
    return words[rng.integers(len(words))]

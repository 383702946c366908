"""The code blocks of a page, run in order as a reader would run them."""

from __future__ import annotations

import contextlib
import io
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from unisg_blender import cli

FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
BLENDER_SAYS = re.compile(r"^(?:Info|Fra|Saved|Time): ?.*\n", re.MULTILINE)
FILE_NAME = re.compile(r"# ([\w-]+\.(?:py|toml|json))\n")


@dataclass(frozen=True)
class Block:
    """A block of a page: its ``language``, its ``text``, and the line that it begins in."""

    language: str
    text: str
    line: int


def blocks(page: str) -> Iterator[Block]:
    """The fenced blocks in order."""
    for match in FENCE.finditer(page):
        yield Block(match[1], match[2], page.count("\n", 0, match.start()) + 1)


def run_page(page: str, folder: Path) -> None:
    """Run the blocks of a page in a folder that is the current one; what follows as ``text`` must be what they print.

    ``python`` blocks share their names; ``bash`` blocks are lines of ``unisg`` and ``python``. A block that begins
    with a file's name as a comment is that file. ``...`` in an output stands for anything.
    """
    names: dict[str, Any] = {"__name__": "page"}
    printed = None
    for block in blocks(page):
        if named := FILE_NAME.match(block.text):
            (folder / named[1]).write_text(block.text, "utf-8")
        elif block.language == "text":
            assert printed is not None, f"line {block.line}: an output of nothing"
            assert re.fullmatch(_pattern(block.text), printed.strip()), f"line {block.line}: it prints\n{printed}"
        elif block.language == "python":
            printed = _python(block, names)
        elif block.language == "bash":
            printed = "".join(_command(line, block.line) for line in command_lines(block.text))


def command_lines(text: str) -> Iterator[list[str]]:
    """The words of each command of a block."""
    for line in text.replace("\\\n", " ").splitlines():
        if words := shlex.split(line, comments=True):
            yield words


def _pattern(text: str) -> re.Pattern[str]:
    return re.compile(".*".join(re.escape(part) for part in text.strip().split("...")), re.DOTALL)


def _python(block: Block, names: dict[str, Any]) -> str:
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile("\n" * block.line + block.text, "page", "exec"), names)
    return BLENDER_SAYS.sub("", out.getvalue())


def _command(words: list[str], line: int) -> str:
    """What a command prints; it must end with status 0."""
    if words[0] == "unisg":
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            status = cli.main(words[1:])
        printed = BLENDER_SAYS.sub("", out.getvalue())
    else:
        assert words[0] == "python", f"line {line}: {words[0]} is no command of this guide"
        done = subprocess.run([sys.executable, *words[1:]], stdout=subprocess.PIPE, text=True, timeout=240)
        status, printed = done.returncode, BLENDER_SAYS.sub("", done.stdout)
    assert status == 0, f"line {line}: {shlex.join(words)} ended with {status}"
    return printed

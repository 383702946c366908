"""Every command and block of the guide and of README.md runs as it stands there, and prints what stands below it."""

from __future__ import annotations

import re
import subprocess
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest
import write_command_page
from architecture import ROOT

from tests.guide.page_blocks import Block, blocks, command_lines, run_page
from unisg_blender import cli

INDEX = (ROOT / "docs" / "index.md").read_text("utf-8")
GUIDE = [
    ROOT / "README.md",
    *(ROOT / "docs" / f"{name}.md" for name in re.findall(r"^(guide/[\w-]+)$", INDEX, re.MULTILINE)),
]
"""As they are read, one after another."""
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
UNISG = ("unisg ", "python -m unisg_blender ", "blender --command unisg ")


def relative(page: Path) -> str:
    """How a page is called in a test's name."""
    return page.relative_to(ROOT).as_posix()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder in which a reader follows the whole guide: no page may need, or stumble over, what another made."""
    return tmp_path_factory.mktemp("reader")


@pytest.mark.slow
@pytest.mark.parametrize("page", GUIDE, ids=relative)
def test_a_page_runs_from_top_to_bottom(page: Path, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    run_page(page.read_text("utf-8"), folder)


def test_every_page_of_the_guide_is_in_the_index() -> None:
    assert set(GUIDE[1:]) == {*(ROOT / "docs" / "guide").glob("*.md")}


def test_the_page_of_the_command_line_is_that_of_the_parsers() -> None:
    assert write_command_page.page() == write_command_page.PAGE.read_text("utf-8"), "make docs"


def commands(page: Path) -> Iterator[tuple[Block, list[str]]]:
    """The commands in blocks of a page, whatever their language."""
    for block in blocks(page.read_text("utf-8")):
        if block.language in ("", "bash"):
            for line in block.text.replace("\\\n", " ").splitlines():
                if line.startswith((*UNISG, "make ", "pip ")):
                    yield from ((block, words) for words in command_lines(line))


@pytest.mark.parametrize("page", PAGES, ids=relative)
def test_commands_of_all_pages_are_understood(page: Path) -> None:
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["optional-dependencies"]
    for block, words in commands(page):
        where = f"line {block.line}: {' '.join(words)}"
        if words[0] == "make":
            made = subprocess.run(["make", "-n", *words[1:]], cwd=ROOT, stdout=subprocess.DEVNULL)
            assert made.returncode == 0, where
        elif words[0] == "pip":
            assert not set(re.findall(r"\[([\w,]+)\]", words[-1])) - {*extras}, where
        else:
            words = words[next(k for k, word in enumerate(words) if word in ("unisg", "unisg_blender")) + 1 :]
            if words[0] in cli.VERBS:
                cli._verb_parser(words[0])[0].parse_args(words[1:])


@pytest.mark.parametrize("page", PAGES, ids=relative)
def test_blocks_of_python_can_be_compiled(page: Path) -> None:
    for block in blocks(page.read_text("utf-8")):
        if block.language == "python":
            compile(block.text, f"{page.name}, line {block.line}", "exec")

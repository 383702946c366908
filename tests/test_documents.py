"""What the documents name exists: files, folders, modules, definitions; and the arrows shown are those held."""

from __future__ import annotations

import ast
import json
import re
from pathlib import Path

import page_numbers
import pytest
from architecture import ARROWS, LAYERS, LIBRARY, ROOT, Module, modules
from result_files import RESULTS

from unisg_blender.dataset.assets.asset_collector import SHELLS
from unisg_blender.spatial.relation_tolerances import RelationTolerances

PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")])
ARCHITECTURE = ROOT / "docs" / "architecture.md"
FOLDERS = "unisg_blender|operators|panels|packaging|benchmarks|tests|docs"
PATH = re.compile(rf"(?<![\w/.@-])(?:{FOLDERS})/[\w./-]*[\w/]")
DOTTED = re.compile(r"(?<![\w./-])unisg_blender(?:\.\w+)+")
FROM_IMPORT = re.compile(r"^from (unisg_blender[\w.]*) import \(?([\w, ]+)", re.MULTILINE)
LINK = re.compile(r"\]\((?!https?:|#|mailto:)([^)#\s]+)")
COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
FILE_AND_NAME = re.compile(r"`((?:\w+/)*\w+\.py): ([\w.]+)`")
FILE = re.compile(r"`((?:\w+/)*\w+\.py|(?:\w+/)+)`")
WRITTEN_BY_HISTORY = {"CHANGELOG.md"}


def names_in(module: Module) -> set[str]:
    """What a module defines or imports at its top level, what it gives lazily included."""
    found = set()
    for node in module.tree.body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            found.add(node.name)
        elif isinstance(node, ast.Import | ast.ImportFrom):
            found |= {alias.asname or alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            found |= {name.id for target in targets for name in ast.walk(target) if isinstance(name, ast.Name)}
            if node.value is not None and ast.unparse(targets[0]) == "__all__":
                found |= set(ast.literal_eval(node.value))
    return found


def members_of(module: Module, name: str) -> set[str]:
    """Methods, properties and fields of a class of a module."""
    body = next((node.body for node in module.tree.body if isinstance(node, ast.ClassDef) and node.name == name), [])
    fields = {node.target.id for node in body if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name)}
    return fields | {node.name for node in body if isinstance(node, ast.FunctionDef)}


def exists(dotted: str) -> bool:
    """Whether a dotted name is a module, or something in one, or a member of a class there."""
    known, parts = modules(), dotted.split(".")
    for count in range(len(parts), 0, -1):
        module, rest = known.get(".".join(parts[:count])), parts[count:]
        if module is not None:
            return not rest or (rest[0] in names_in(module) and (len(rest) == 1 or bool(members_of(module, rest[0]))))
    return False


def relative(page: Path) -> str:
    """How a page is called in a test's name."""
    return page.relative_to(ROOT).as_posix()


@pytest.mark.parametrize("page", [page for page in PAGES if page.name not in WRITTEN_BY_HISTORY], ids=relative)
def test_paths_and_modules_exist(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    missing = [path for path in PATH.findall(text) if not (ROOT / path).exists()]
    missing += [name for name in DOTTED.findall(text) if not exists(name)]
    imported = [f"{module}.{name.strip()}" for module, names in FROM_IMPORT.findall(text) for name in names.split(",")]
    missing += [name for name in imported if not exists(name.rstrip("."))]
    assert not missing, "\n".join(missing)


@pytest.mark.parametrize("page", PAGES, ids=relative)
def test_links_lead_somewhere(page: Path) -> None:
    links = LINK.findall(COMMENT.sub("", page.read_text(encoding="utf-8")))
    missing = [link for link in links if not (page.parent / link).exists()]
    assert not missing, "\n".join(missing)


@pytest.mark.slow
def test_architecture_names_what_is_there() -> None:
    text = ARCHITECTURE.read_text(encoding="utf-8")
    by_path = {module.path.as_posix().removeprefix(f"{LIBRARY}/"): module for module in modules().values()}
    named = FILE_AND_NAME.findall(text)
    assert len(named) > 50
    missing = []
    for path, name in named:
        module, (first, *rest) = by_path.get(path), name.split(".")
        if module is None or first not in names_in(module) or (rest and rest[0] not in members_of(module, first)):
            missing.append(f"{path}: {name}")
    tops = (ROOT, ROOT / LIBRARY)
    missing += [path for path in FILE.findall(text) if not any((top / path).exists() for top in tops)]
    assert not missing, "\n".join(missing)


def test_the_table_of_arrows_is_the_one_that_is_held() -> None:
    table = ARCHITECTURE.read_text(encoding="utf-8").partition("<!-- arrows -->")[2].partition("<!-- end -->")[0]
    rows = re.findall(r"^\| `(\w+)` \| (.*) \|$", table, re.MULTILINE)
    assert {room: set(re.findall(r"`(\w+)`", targets)) for room, targets in rows} == ARROWS, "make docs"


def test_contributing_shows_the_layers() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    assert "\n".join(", ".join(rooms) for rooms in LAYERS.values()) in text


@pytest.mark.parametrize("page", page_numbers.PAGES, ids=relative)
def test_numbers_are_those_of_the_files(page: Path) -> None:
    text, faults = page_numbers.page_text(page.read_text("utf-8"))
    assert not faults, "\n".join(faults)
    assert text == page.read_text("utf-8"), "make docs"


@pytest.mark.parametrize("page", page_numbers.PAGES, ids=relative)
def test_no_source_is_itself_a_number(page: Path) -> None:
    sources = [block.source for block in page_numbers.blocks(page.read_text("utf-8")) if block.kind == "from"]
    parts = [part.strip() for source in sources for part in source.split(";")]
    assert not [part for part in parts if re.fullmatch(r"[-+\d.e_ */()]*\d[-+\d.e_ */()]*", part) and part[0] != "_"]


FROM_A_FILE = "Errors are 9.9 cm and 8 degrees of 90.\n<!-- from 2.345; abs(-7.6); _ -->\n"
ROWS = """| form | key frames |
|---|---|
<!-- rows m = motion["reductions"]; m.where(method="motors", motion="door, eased")
  | {motion} | {key_frames:.1f} {cell(None, ".1f")} {m("method", motion, "motors")} | -->
"""


def test_numbers_of_pages_are_written_from_their_sources() -> None:
    text, faults = page_numbers.page_text(FROM_A_FILE)
    assert not faults
    assert text == FROM_A_FILE.replace("9.9", "2.3")
    item = "- An item: 1,000 of `2` on 2026-01-01, −0.50.\n  <!-- from 12345.6; -0.123 -->\n- Another, without.\n"
    assert page_numbers.page_text(item) == (item.replace("1,000", "12,346").replace("−0.50", "−0.12"), [])


def test_the_rows_of_a_table_are_written_from_those_of_a_file() -> None:
    text, faults = page_numbers.page_text(ROWS)
    assert not faults
    key_frames = page_numbers.results()["motion"]["reductions"]("key_frames", "door, eased", "motors")
    assert text == ROWS.replace("<!--", f"| door, eased | {key_frames}.0  motors |\n<!--", 1)
    assert page_numbers.page_text(text) == (text, [])


def test_constants_are_read_without_importing_their_modules() -> None:
    assert page_numbers.constant("dataset.assets.asset_collector:SHELLS") == SHELLS
    assert page_numbers.constant("learn.anchors.pair_geometry:TURNS") == 4  # one of two that are set at once
    assert page_numbers.constant("spatial.relation_tolerances:RelationTolerances.above") == RelationTolerances().above


@pytest.mark.parametrize(
    ("page", "fault"),
    [
        ("It took 12 ms.\n", "no source"),
        ("Twelve rooms, 12.\n", "no source"),
        ("It took 12 ms.\n<!-- from 12; 13 -->\n", "1 numbers"),
        ("It took 12 ms.\n<!-- from nothing -->\n", "nothing"),
        ('It took 12 ms.\n<!-- from paper_poses("cm_median") -->\n', "cells"),
        ("| a |\n|---|\n| 1 |\n<!-- in layouts -->\n", "no source"),
        ("| a |\n|---|\n| 1 |\n<!-- rows layouts | {room} | -->\n", "ValueError"),
        ("It took 12 ms.\n<!-- hand measured-once -->\n", "no source"),
        ('It took 12 ms.\n<!-- from constant("generate.generator:NO_SUCH") -->\n', "NO_SUCH"),
    ],
)
def test_numbers_without_a_source_are_told(page: str, fault: str) -> None:
    text, (told,) = page_numbers.page_text(page)
    assert fault in told
    assert text == page


@pytest.mark.parametrize("path", sorted(RESULTS.glob("*.json")), ids=relative)
def test_a_file_of_results_says_by_which_command_it_was_made(path: Path) -> None:
    record = json.loads(path.read_text("utf-8"))
    assert re.fullmatch(r"\d{4}-\d\d-\d\d", record["date"])
    program, *words = record["command"].split()
    assert program == "unisg" or (ROOT / words[0]).is_file()


def test_what_was_tried_once_has_date_and_command_and_is_used() -> None:
    pages = "".join(page.read_text("utf-8") for page in page_numbers.PAGES)
    for row in page_numbers.results()["tried"].rows:
        assert re.fullmatch(r"\d{4}-\d\d-\d\d", row["date"])
        assert row["command"]
        assert f'"{row["measure"]}"' in pages

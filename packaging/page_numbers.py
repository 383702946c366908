"""Write the measured numbers of README.md and docs/ from the files of docs/results/.

    python packaging/page_numbers.py

A comment right after a paragraph, list item or table says where its numbers come from:

``<!-- from paper_poses("cm_median", "target, base case", "sixd"); _; 100 * x -->``
    One expression for each number, in order; ``_`` leaves a number that is no measurement, ``_4`` the next four.
    A name is a file of docs/results/ without its ending: CSV files and lists of rows are a :class:`Table`.
``<!-- table poses -->``
    The whole table, as ``unisg benchmark paper`` writes it of ``paper_poses.csv``.
``<!-- in meshes -->``
    Each number stands somewhere in that file: for tables that other scripts wrote.
``<!-- hand reading-1 -->``
    The numbers of that entry of docs/results/by_hand.json, where no file has them: with date and command. Among others
    the third of them is the expression ``hand("reading-1", 2)``.
``<!-- chosen -->``
    Settings, limits and definitions: nothing was measured.

In docs/results/ and docs/models/ every block with a number must have one of them, elsewhere every block with a number
and a unit of what is measured.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from result_files import NUMBER, RESULTS, by_hand, in_files, results

ROOT = Path(__file__).resolve().parents[1]
HAND = RESULTS / "by_hand.json"
REPORTS = ("results", "models")
WRITTEN_ELSEWHERE = {"api.md", "architecture.md"}
PAGES = [
    ROOT / "README.md",
    *sorted(page for page in (ROOT / "docs").rglob("*.md") if page.name not in WRITTEN_ELSEWHERE),
]

MARK = re.compile(r"[ \t]*<!-- (from|table|in|hand|chosen)\b\s*(.*?)\s*-->", re.DOTALL)
MEASURED = re.compile(
    r"\d (?:%|[mnµ]?s|GiB|[kKMG]B|[cm]m|m²|hours|min(?:utes)?|seconds|degrees|nats|points|times)(?!\w)|± ?\d|\d\.\d{2}"
)
HIDDEN = re.compile(r"`[^`\n]*`|\]\([^)]*\)|https?:\S+|\d{4}-\d\d-\d\d|\bv?\d+\.\d+\.\d+\b|§ ?\d+", re.DOTALL)
NO_TEXT = re.compile(r"^[ \t]*```.*?^[ \t]*```|<!--.*?-->", re.DOTALL | re.MULTILINE)
BLOCK = re.compile(r"^[ \t]*[^\s#].*\n(?:(?![ \t]*(?:[-*] |\d+\. |#))[ \t]*\S.*\n)*", re.MULTILINE)
"""A line with text that is no heading, and those behind it up to an empty one, a heading or a list item."""

BUILTINS = {"min": min, "max": max, "len": len, "sum": sum, "abs": abs}


@dataclass(frozen=True)
class Block:
    """A paragraph, list item or table of a page, and what the comment behind it says."""

    start: int
    end: int
    text: str
    kind: str
    source: str


def blocks(page: str) -> Iterator[Block]:
    """The blocks of a page in order; code, headings and comments are none."""
    shown = NO_TEXT.sub(lambda match: re.sub(r"\S", " ", match.group()), page)
    for match in BLOCK.finditer(shown):
        mark = MARK.match(page, match.end())
        yield Block(
            match.start(), match.end(), page[match.start() : match.end()], *(mark.groups() if mark else ("", ""))
        )


def numbers(text: str) -> list[re.Match[str]]:
    """The numbers of a text that readers see as such: not those in code, links, dates and versions."""
    return list(NUMBER.finditer(HIDDEN.sub(lambda match: "`" * len(match.group()), text)))


def written(value: float, like: str) -> str:
    """A number as the page writes it: as many digits behind the point, thousands, exponent and minus alike."""
    digits = len(like.partition("e")[0].partition(".")[2])
    if "e" in like:
        mantissa, power = f"{value:.{digits}e}".split("e")
        text = f"{mantissa}e{int(power)}"
    else:
        text = f"{value:{',' if ',' in like else ''}.{digits}f}"
        text = text.removeprefix("-") if not float(text.replace(",", "")) else text
    return text.replace("-", "−") if "−" in like and "e" not in like else text


def made(block: Block) -> str:
    """The block as its source says that it should be.

    Raises
    ------
    ValueError
        If the source has more or fewer numbers than the block, or does not know one.
    """
    found = numbers(block.text)
    if block.kind == "table":
        return paper_table(block.source)
    if block.kind == "in":
        head = block.text.index("\n") if block.text.lstrip().startswith("|") else 0  # a table's first line has names
        known = in_files(block.source.split())
        strange = [match.group() for match in found if match.start() >= head and not stands(match.group(), known)]
        if strange:
            raise ValueError(f"not in {block.source}: {', '.join(strange)}")
    if block.kind not in ("hand", "from"):
        return block.text
    values = results()["by_hand"][block.source]["numbers"] if block.kind == "hand" else evaluated(block.source)
    if len(values) != len(found):
        raise ValueError(f"{[match.group() for match in found]} are {len(found)} numbers, the source has {len(values)}")
    text = block.text
    for match, value in reversed(list(zip(found, values, strict=True))):
        new = match.group() if value is None else value if isinstance(value, str) else written(value, match.group())
        text = text[: match.start()] + new + text[match.end() :]
    return text


def paper_table(name: str) -> str:
    """A table of ``unisg benchmark paper``, from its CSV file."""
    from unisg_blender.experiments.paper.paper_report import MARKDOWN
    from unisg_blender.experiments.paper.paper_tables import to_markdown

    return to_markdown(results()[f"paper_{name}"].rows, MARKDOWN[name][1]) + "\n"


def evaluated(source: str) -> list[float | None]:
    """The values of a ``from`` comment's expressions, None for ``_``; ``name = expression`` gives no value."""
    names: dict[str, Any] = {"__builtins__": {}} | BUILTINS | results() | {"hand": by_hand}
    values: list[float | None] = []
    for part in map(str.strip, source.split(";")):
        if skipped := re.fullmatch(r"_(\d*)", part):
            values += [None] * int(skipped[1] or 1)
        elif assigned := re.match(r"(\w+) = ", part):
            names[assigned[1]] = eval(part[assigned.end() :], names)
        else:
            values.append(eval(part, names))
    return values


def stands(number: str, known: set[float]) -> bool:
    """Whether a number is one of those, as it is written, or in percent."""
    digits = number.partition(".")[2]
    shown, half = float(number.replace(",", "").replace("−", "-")), 0.5 * 10.0 ** -len(digits) + 1e-9
    return any(abs(factor * value - shown) <= half for value in known for factor in (1, 100))


def page_text(page: str, report: bool) -> tuple[str, list[str]]:
    """A page with its numbers as the files have them, and what cannot be said: one line each.

    ``report``: whether every block with a number must have a source.
    """
    faults = []
    for block in reversed(list(blocks(page))):
        shown = repr(block.text.strip()[:90])
        if not block.kind and (MEASURED.search(HIDDEN.sub("", block.text)) or (report and numbers(block.text))):
            faults.append(f"no source: {shown}")
        try:
            page = page[: block.start] + made(block) + page[block.end :]
        except Exception as error:  # expressions fail in any way
            faults.append(f"{error!r}: {shown}")
    return page, faults[::-1]


def current(page: Path) -> tuple[str, list[str]]:
    """:func:`page_text` of a page of the project."""
    return page_text(page.read_text("utf-8"), page.parent.name in REPORTS)


def main() -> int:
    """Write all pages; 1 if a number has no source."""
    faulty = False
    for page in PAGES:
        text, faults = current(page)
        page.write_text(text, "utf-8")
        for fault in faults:
            print(f"{page.relative_to(ROOT)}: {fault}", file=sys.stderr)
        faulty |= bool(faults)
    count = sum(len(entry["numbers"]) for entry in results()["by_hand"].values())
    print(f"{count} numbers are measured by hand ({HAND.relative_to(ROOT)})")
    return int(faulty)


if __name__ == "__main__":
    sys.exit(main())

"""Write the measured numbers of README.md and docs/ from the files of docs/results/.

    python packaging/page_numbers.py

A comment right after a paragraph, list item or table says where its numbers come from:

``<!-- from paper_poses("cm_median", "target, base case", "sixd"); _; 100 * x -->``
    One expression for each number, in order; ``_`` leaves a number that is no measurement, ``_4`` the next four.
    A name is a file of docs/results/ without its ending: CSV files and lists of rows are a :class:`Table`.
    ``constant("generate.place.placer:TRIED")`` is a constant of the library, ``model("topology")`` what a shipped
    model's file says of itself, ``megabytes("topology.onnx")`` the size of a shipped file.
``<!-- rows usd["sizes"] | {objects:,} | {read_s:.1f} | -->``
    The whole table below its head: a line for each row of that table, written by an f-string of its columns;
    ``{cell(x, ".2f")}`` is empty where there is no value, ``mean_and_spread`` reads tables of ``unisg evaluate``.
``<!-- table poses -->``
    The whole table, as ``unisg benchmark paper`` writes it of ``paper_poses.csv``.
``<!-- chosen -->``
    Settings, limits and definitions: nothing was measured.

Every block with a number must have one of them. A file of docs/results/ says by which command it was made. What takes
hours, and what was tried and is not in the code any more, is a line of ``tried.csv``, with date and command.
"""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from result_files import NUMBER, ROOT, Table, constant, megabytes, model, results

GENERATED = {"api.md", "commands.md"}
"""Made of docstrings, and of the parsers of the command line."""

PAGES = [ROOT / "README.md", *sorted(page for page in (ROOT / "docs").rglob("*.md") if page.name not in GENERATED)]
"""Those that people write."""

MARK = re.compile(r"[ \t]*<!-- (from|rows|table|chosen)\b\s*(.*?)\s*-->", re.DOTALL)
HIDDEN = re.compile(
    r"`[^`\n]*`|\]\([^)]*\)|https?:\S+|\d{4}-\d\d-\d\d|\bv?\d+\.\d+\.\d+\b|§ ?\d+|^[ \t]*\d+\.(?= )"
    r"|\b(?:19\d|20[0-2])\d\b|x86-64|(?:GPL|CC-BY|CC|Blender|Python|bpy|numpy|torch|USD)[ -]\d+(?:\.\d+)?",
    re.DOTALL | re.MULTILINE,
)
"""What readers do not take for a number: code, links, dates, years, versions, the numbers of a list."""

NO_TEXT = re.compile(r"^[ \t]*```.*?^[ \t]*```|<!--.*?-->", re.DOTALL | re.MULTILINE)
BLOCK = re.compile(r"^[ \t]*[^\s#].*\n(?:(?![ \t]*(?:[-*] |\d+\. |#))[ \t]*\S.*\n)*", re.MULTILINE)
"""A line with text that is no heading, and those behind it up to an empty one, a heading or a list item."""

BUILTINS = {"log": math.log, "min": min, "max": max, "len": len, "sum": sum, "abs": abs, "str": str, "sorted": sorted}


def cell(value: float | None, form: str) -> str:
    """A number in a format, nothing where there is none."""
    return "" if value is None else format(value, form)


def mean_and_spread(table: Table, row: str, value: str, digits: int, factor: float = 1.0) -> str:
    """The mean of a value in a row of ``unisg evaluate``, and its standard deviation if it shows; else nothing."""
    lines = table.where(row=row, value=value).rows
    texts = [f"{factor * (line[name] or 0):.{digits}f}" for line in lines for name in ("mean", "spread")]
    return " ± ".join(text for place, text in enumerate(texts) if not place or float(text))


SOURCES = {
    "constant": constant, "model": model, "megabytes": megabytes, "cell": cell, "mean_and_spread": mean_and_spread,
}  # fmt: skip


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
    if block.kind == "rows":
        return written_rows(block)
    if block.kind != "from":
        return block.text
    values = evaluated(block.source)[1]
    if len(values) != len(found):
        raise ValueError(f"{[match.group() for match in found]} are {len(found)} numbers, the source has {len(values)}")
    text = block.text
    for match, value in reversed(list(zip(found, values, strict=True))):
        new = match.group() if value is None else written(value, match.group())
        text = text[: match.start()] + new + text[match.end() :]
    return text


def paper_table(name: str) -> str:
    """A table of ``unisg benchmark paper``, from its CSV file."""
    from unisg_blender.experiments.paper.paper_report import MARKDOWN
    from unisg_blender.experiments.paper.paper_tables import to_markdown

    return to_markdown(results()[f"paper_{name}"].rows, MARKDOWN[name][1]) + "\n"


def written_rows(block: Block) -> str:
    """A table as its template writes it, under the head that stands on the page."""
    expressions, bar, line = block.source.partition("|")
    head, template = block.text.splitlines()[:2], f"f'''{bar} {' '.join(line.split())}'''"
    names, (table,) = evaluated(expressions)
    rows = table.rows if isinstance(table, Table) else table
    return "\n".join([*head, *(eval(template, names | {"row": row} | dict(row)) for row in rows)]) + "\n"


def evaluated(source: str) -> tuple[dict[str, Any], list[Any]]:
    """The values of expressions, None for ``_``, and the names they know; ``name = expression`` gives no value."""
    names: dict[str, Any] = {"__builtins__": {}} | BUILTINS | SOURCES | results()
    values: list[Any] = []
    for part in map(str.strip, source.split(";")):
        if skipped := re.fullmatch(r"_(\d*)", part):
            values += [None] * int(skipped[1] or 1)
        elif assigned := re.match(r"(\w+) = ", part):
            names[assigned[1]] = eval(part[assigned.end() :], names)
        else:
            values.append(eval(part, names))
    return names, values


def page_text(page: str) -> tuple[str, list[str]]:
    """A page with its numbers as the files have them, and what cannot be said: one line each."""
    faults = []
    for block in reversed(list(blocks(page))):
        shown = repr(block.text.strip()[:90])
        if not block.kind and numbers(block.text):
            faults.append(f"no source: {shown}")
        try:
            page = page[: block.start] + made(block) + page[block.end :]
        except Exception as error:  # expressions fail in any way
            faults.append(f"{error!r}: {shown}")
    return page, faults[::-1]


def main() -> int:
    """Write all pages; 1 if a number has no source."""
    faulty = False
    for page in PAGES:
        text, faults = page_text(page.read_text("utf-8"))
        page.write_text(text, "utf-8")
        for fault in faults:
            print(f"{page.relative_to(ROOT)}: {fault}", file=sys.stderr)
        faulty |= bool(faults)
    return int(faulty)


if __name__ == "__main__":
    sys.exit(main())

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

import csv
import json
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
RESULTS = ROOT / "docs" / "results"
HAND = RESULTS / "by_hand.json"
REPORTS = ("results", "models")
WRITTEN_ELSEWHERE = {"api.md", "architecture.md"}
PAGES = [
    ROOT / "README.md",
    *sorted(page for page in (ROOT / "docs").rglob("*.md") if page.name not in WRITTEN_ELSEWHERE),
]

MARK = re.compile(r"[ \t]*<!-- (from|table|in|hand|chosen)\b\s*(.*?)\s*-->", re.DOTALL)
NUMBER = re.compile(r"(?<![\w.,])[-−]?\d+(?:,\d{3})*(?:\.\d+)?(?:e[-+]?\d+)?(?!\w|[.,]\d)")
MEASURED = re.compile(
    r"\d (?:%|ms|ns|µs|s|GiB|[kKMG]B|cm|mm|m²|hours|minutes|min|seconds|degrees|nats|points|times)(?!\w)|± ?\d|\d\.\d{2}"
)
HIDDEN = re.compile(r"`[^`\n]*`|\]\([^)]*\)|https?:\S+|\d{4}-\d\d-\d\d|\bv?\d+\.\d+\.\d+\b|§ ?\d+", re.DOTALL)
ITEM = re.compile(r"\s*(?:[-*]|\d+\.) ")
BUILTINS = {"min": min, "max": max, "len": len, "sum": sum, "abs": abs}


class Table:
    """Rows of a file: ``table("cm_median", "target, base case", form="sixd")`` is one cell, ``all`` a list of them."""

    def __init__(self, rows: Sequence[Mapping[str, Any]]) -> None:
        self.rows = rows

    def all(self, column: str, *first: Any, **where: Any) -> list[Any]:
        """The cells of a column in rows whose first columns have these values, others those (one, or a tuple)."""
        wanted = dict(zip(self.rows[0], first, strict=False)) | where
        allowed = {name: value if isinstance(value, tuple) else (value,) for name, value in wanted.items()}
        cells = [row.get(column) for row in self.rows if all(row[name] in among for name, among in allowed.items())]
        return [cell for cell in cells if cell is not None]

    def __call__(self, column: str, *first: Any, **where: Any) -> Any:
        """The only such cell."""
        found = self.all(column, *first, **where)
        if len(found) != 1:
            raise ValueError(f"{len(found)} cells of {column!r} for {first} {where}")
        return found[0]


def parsed(cell: str) -> Any:
    """A CSV cell as a number where it is one; None if empty."""
    for kind in (int, float):
        try:
            return kind(cell)
        except ValueError:
            continue
    return cell or None


@cache
def results() -> dict[str, Any]:
    """What the files of docs/results/ hold, by their names without ending."""
    found: dict[str, Any] = {}
    for path in sorted(RESULTS.glob("*.json")):
        found[path.stem] = json.loads(path.read_text("utf-8"), object_hook=_with_tables)
    for path in sorted(RESULTS.glob("*.csv")):
        with path.open(encoding="utf-8", newline="") as file:
            rows = [{name: parsed(cell) for name, cell in row.items()} for row in csv.DictReader(file)]
        found[f"{path.stem}_csv" if path.stem in found else path.stem] = Table(rows)
    return found


def _with_tables(record: dict[str, Any]) -> dict[str, Any]:
    """Lists of rows as tables."""
    tables = {key: Table(value) for key, value in record.items() if isinstance(value, list) and value}
    return record | {key: table for key, table in tables.items() if isinstance(table.rows[0], Mapping)}


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
    start, position, fenced = 0, 0, False
    for line in [*page.splitlines(keepends=True), "\n"]:
        fence = line.lstrip().startswith("```")
        mark = MARK.match(page, position) if not fenced else None
        ends = not line.strip() or fence or fenced or line.startswith(("#", "<!--")) or mark or ITEM.match(line)
        if ends and position > start and page[start:position].strip():
            kind, source = mark.groups() if mark else ("", "")
            yield Block(start, position, page[start:position], kind, source)
        fenced ^= fence
        position += len(line)
        if ends and not (ITEM.match(line) and not fenced and not fence):
            start = position
        elif ends:
            start = position - len(line)
        if mark:
            start = max(start, mark.end())


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


def expressions(source: str) -> list[str]:
    """The expressions of a ``from`` comment, ``_4`` spelled out."""
    parts = [part.strip() for part in source.split(";")]
    return [one for part in parts for one in (["_"] * int(part[1:] or 1) if re.fullmatch(r"_\d*", part) else [part])]


def made(block: Block) -> str:
    """The block as its source says that it should be.

    Raises
    ------
    ValueError
        If the source has more or fewer numbers than the block, or does not know one.
    """
    found = numbers(block.text)
    if block.kind == "table":
        from unisg_blender.experiments.paper.paper_report import MARKDOWN
        from unisg_blender.experiments.paper.paper_tables import to_markdown

        return to_markdown(results()[f"paper_{block.source}"].rows, MARKDOWN[block.source][1]) + "\n"
    if block.kind == "in":
        known = in_files(block.source.split())
        head = block.text.index("\n") if block.text.lstrip().startswith("|") else 0  # a table's first line has names
        strange = [match.group() for match in found if match.start() >= head and not stands(match.group(), known)]
        if strange:
            raise ValueError(f"not in {block.source}: {', '.join(strange)}")
        return block.text
    if block.kind == "hand":
        new = results()["by_hand"][block.source]["numbers"]
    elif block.kind == "from":
        names = BUILTINS | results() | {"hand": by_hand}
        listed = expressions(block.source)
        local = {}
        while listed and (assigned := re.match(r"(\w+) = (.+)", listed[0], re.DOTALL)):
            local[assigned[1]] = eval(assigned[2], {"__builtins__": {}} | names | local)
            listed.pop(0)
        if len(listed) != len(found):
            raise ValueError(f"{len(found)} numbers ({', '.join(match.group() for match in found)}), {len(listed)} sources")
        values = [None if one == "_" else eval(one, {"__builtins__": {}} | names | local) for one in listed]
        new = [
            match.group() if value is None else written(value, match.group())
            for match, value in zip(found, values, strict=True)
        ]
    else:
        return block.text
    if len(new) != len(found):
        raise ValueError(f"{len(found)} numbers, {len(new)} in its source")
    text = block.text
    for match, number in reversed(list(zip(found, new, strict=True))):
        text = text[: match.start()] + number + text[match.end() :]
    return text


def by_hand(key: str, place: int) -> float:
    """One number of an entry of ``by_hand.json``."""
    return float(results()["by_hand"][key]["numbers"][place].replace(",", "").replace("−", "-"))


def in_files(names: Sequence[str]) -> set[float]:
    """All numbers in some files, those in words too."""
    known: set[float] = set()
    left = [results()[name] for name in names]
    while left:
        value = left.pop()
        if isinstance(value, Table):
            left += value.rows
        elif isinstance(value, Mapping):
            left += [*value.keys(), *value.values()]
        elif isinstance(value, list):
            left += value
        elif isinstance(value, str):
            known |= {float(match.group().replace(",", "").replace("−", "-")) for match in NUMBER.finditer(value)}
        elif isinstance(value, int | float):
            known.add(float(value))
    return known


def stands(number: str, known: set[float]) -> bool:
    """Whether a number is one of those, as it is written, or in percent."""
    digits = number.partition(".")[2]
    shown, half = float(number.replace(",", "").replace("−", "-")), 0.5 * 10.0 ** -len(digits) + 1e-9
    return any(abs(factor * value - shown) <= half for value in known for factor in (1, 100))


def page_text(page: Path) -> tuple[str, list[str]]:
    """The page with its numbers as the files have them, and what cannot be said: one line each."""
    text = page.read_text("utf-8")
    faults = []
    for block in reversed(list(blocks(text))):
        told = MEASURED.search(HIDDEN.sub("", block.text)) or (page.parent.name in REPORTS and numbers(block.text))
        if told and not block.kind:
            faults.append(f"{page.relative_to(ROOT)}: no source: {block.text.strip()[:90]!r}")
        try:
            text = text[: block.start] + made(block) + text[block.end :]
        except Exception as error:  # expressions fail in any way
            faults.append(f"{page.relative_to(ROOT)}: {error!r}: {block.text.strip()[:90]!r}")
    return text, faults[::-1]


def main() -> int:
    """Write all pages; 1 if a number has no source."""
    faults, by_hand = [], sum(len(entry["numbers"]) for entry in results()["by_hand"].values())
    for page in PAGES:
        text, found = page_text(page)
        faults += found
        page.write_text(text, "utf-8")
    print(*faults, f"{by_hand} numbers are measured by hand ({HAND.relative_to(ROOT)})", sep="\n")
    return int(bool(faults))


if __name__ == "__main__":
    sys.exit(main())

"""Names of other people's things: how many are understood, wrongly understood, and left alone.

    python benchmarks/names.py --out docs/results/names.json

``names.csv`` has names of iTHOR, ProcTHOR, TDW, VirtualHome and AWS RoboMaker with the thing that each means, marked by
eye ("" where a name says nothing that the table of words has). The table was made looking at the "dev" part.
"""

from __future__ import annotations

import argparse
import csv
from collections import Counter
from pathlib import Path

from unisg_blender.experiments.reports import markdown_table, write_results
from unisg_blender.words import thing_table

LIST = Path(__file__).with_name("names.csv")
ANSWERS = ("right", "rightly nothing", "wrong", "unknown")


def answer(name: str, thing: str) -> str:
    """What became of a name that means a thing."""
    reading = thing_table().read(name)
    found = "" if reading.part else reading.thing
    if found == thing:
        return "right" if thing else "rightly nothing"
    return "wrong" if found else "unknown"


def main() -> None:
    """Read all names, print, write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    with LIST.open(newline="", encoding="utf-8") as file:
        names = list(csv.DictReader(file))
    rows = []
    for half in dict.fromkeys(row["half"] for row in names):
        mine = [row for row in names if row["half"] == half]
        counts = Counter(answer(row["name"], row["thing"]) for row in mine)
        rows.append({"half": half, "names": len(mine), **{key.replace(" ", "_"): counts[key] for key in ANSWERS}})
    print(markdown_table(list(rows[0]), [list(map(str, row.values())) for row in rows]))
    things = thing_table().things.values()
    every = sum(len(thing.words) >= 7 for thing in things)
    if args.out:
        write_results(args.out, {"names": rows, "things": len(things), "in_seven_languages": every})


if __name__ == "__main__":
    main()

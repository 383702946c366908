"""Run the notebooks of docs/notebooks, and write what they print and draw into them, or compare it with what they hold.

    python packaging/run_notebooks.py [NAME ...] [--check]

Words have to be the same as before, pictures only to be there: another machine draws letters a little otherwise.
"""

from __future__ import annotations

import argparse
import os
import re
import sys
import tempfile
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient

FOLDER = Path(__file__).parents[1] / "docs" / "notebooks"

SECONDS = 300
"""For one cell."""


def main() -> int:
    """Run the notebooks that are named, or all; with --check 1 where one says something else than it holds."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", default=sorted(path.stem for path in FOLDER.glob("*.ipynb")))
    parser.add_argument("--check", action="store_true")
    args = parser.parse_args()
    parted = []
    for name in args.names:
        path = FOLDER / f"{name}.ipynb"
        ran = executed(path)
        if args.check:
            parted += [f"{name}: {difference}" for difference in differences(read(path), ran)]
        else:
            nbformat.write(ran, path)
            print(f"{path.name}: {path.stat().st_size // 1024} kB")
    print("\n".join(parted), end="\n" * bool(parted), file=sys.stderr)
    return int(bool(parted))


def read(path: Path) -> Any:
    """A notebook as it lies in its folder."""
    return nbformat.read(path, as_version=4)


def executed(path: Path) -> Any:
    """A notebook after a run of all its cells in a folder of its own, without what is only noise."""
    notebook = read(path)
    with tempfile.TemporaryDirectory() as folder:
        here = {"metadata": {"path": folder}}
        os.environ |= {"PYTHONPATH": str(FOLDER.parents[1]), "OMP_NUM_THREADS": "1"}
        NotebookClient(notebook, timeout=SECONDS, kernel_name="python3", resources=here).execute()
    for number, cell in enumerate(notebook.cells):
        cell.id, cell.metadata = f"cell-{number}", {}
        if cell.cell_type == "code":
            cell.outputs = _joined(cell.outputs)
    notebook.metadata = {
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"name": "python"},
    }
    return notebook


def _joined(outputs: list[Any]) -> list[Any]:
    """Outputs of a cell: all that it printed as one, then its pictures; what libraries warn of is left out."""
    words = "".join(each.text for each in outputs if each.output_type == "stream" and each.name == "stdout")
    rest = [each for each in outputs if each.output_type != "stream"]
    for each in rest:
        each.metadata = {}
    return [nbformat.v4.new_output("stream", name="stdout", text=words)] * bool(words) + rest


def differences(held: Any, ran: Any) -> list[str]:
    """What a run said or drew otherwise than a notebook holds, a line each."""
    found = []
    for number, (old, new) in enumerate(zip(held.cells, ran.cells, strict=True)):
        if old.cell_type != "code":
            continue
        said, says = _words(old), _words(new)
        if said != says:
            found.append(f"cell {number} says {says!r}, and holds {said!r}")
        drew, draws = _pictures(old), _pictures(new)
        if drew != draws:
            found.append(f"cell {number} draws {draws} pictures, and holds {drew}")
    return found


def _words(cell: Any) -> str:
    words = "".join(each.text for each in cell.outputs if each.output_type == "stream")
    return re.sub(r"-0\.0*(?=\D|$)", lambda match: match[0][1:], words)  # the sign of nothing is rounding


def _pictures(cell: Any) -> int:
    return sum("image/png" in each.get("data", {}) for each in cell.outputs)


if __name__ == "__main__":
    sys.exit(main())

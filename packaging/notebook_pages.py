"""Pages of the site from the notebooks as they lie there, run already: their text, code, what it printed, pictures."""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any


def write_notebook_pages(notebooks: Path, folder: Path) -> None:
    """A page for each notebook of a folder, and its pictures beside it."""
    folder.mkdir(parents=True, exist_ok=True)
    for path in sorted(notebooks.glob("*.ipynb")):
        parts, pictures = [], 0
        for cell in json.loads(path.read_text("utf-8"))["cells"]:
            source = "".join(cell["source"])
            if cell["cell_type"] == "markdown":
                parts.append(source)
                continue
            parts.append(f"```python\n{source}\n```")
            for output in cell["outputs"]:
                if png := output.get("data", {}).get("image/png"):
                    name = f"{path.stem}-{(pictures := pictures + 1)}.png"
                    (folder / name).write_bytes(base64.b64decode("".join(png)))
                    parts.append(f"![]({name})")
                elif text := _printed(output):
                    parts.append(f"```text\n{text.rstrip()}\n```")
        whole = f"The notebook itself: [{path.name}]({path.name})."
        (folder / f"{path.stem}.md").write_text("\n\n".join([parts[0], whole, *parts[1:]]) + "\n", "utf-8")


def _printed(output: dict[str, Any]) -> str:
    """What an output shows as text."""
    return "".join(output.get("text", output.get("data", {}).get("text/plain", "")))

"""What each part of the extension's zip costs, for docs/blender-versions.md.

python packaging/zip_parts.py build/extension/ZIP --out docs/results/zip_parts.json
"""

from __future__ import annotations

import argparse
import datetime
import json
import zipfile
from collections import Counter
from pathlib import Path

WHY = {
    "scipy": "distances between meshes, nearest neighbours, clusters",
    "onnxruntime": "runs the models",
    "models": "those that are shipped, with their shapes, and the words that tell what things are",
    "code": "of the extension and the library, the page that plays lessons in a browser",
    "other wheels": "reading meshes and the models' files",
}
LARGE = 5.0
"""Megabytes from which on a wheel has a line of its own."""


def parts_of(path: Path) -> list[dict[str, object]]:
    """Megabytes by part of a zip, the largest first."""
    sizes: Counter[str] = Counter()
    wheels: Counter[str] = Counter()
    with zipfile.ZipFile(path) as zipped:
        for item in zipped.infolist():
            size = item.compress_size / 1e6
            if item.filename.endswith(".whl"):
                wheels[Path(item.filename).name.split("-")[0]] += size
            else:
                sizes["models" if "/pretrained/" in f"/{item.filename}" else "code"] += size
    for name, size in wheels.items():
        sizes[name if size >= LARGE else "other wheels"] += size
    return [{"part": name, "mb": round(size, 2), "why": WHY.get(name, "")} for name, size in sizes.most_common()]


def main() -> None:
    """Write the file."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("zip", type=Path, help="a zip of build_extension.py")
    parser.add_argument("--out", type=Path, required=True, help="JSON file to write")
    args = parser.parse_args()
    record = {
        "command": f"python packaging/zip_parts.py build/extension/{args.zip.name} --out docs/results/zip_parts.json",
        "date": datetime.date.today().isoformat(),
        "zip": args.zip.name,
        "mb": round(args.zip.stat().st_size / 1e6, 1),
        "parts": parts_of(args.zip),
    }
    args.out.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()

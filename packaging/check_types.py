"""Check the types of library, operators and panels together, as one package: python packaging/check_types.py

Inside Blender the repository's root is a package, whatever its folder is called, and operators import
the library relative to it. mypy wants a name for that package, so the three stand in one by links.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PARTS = ("unisg_blender", "operators", "panels")


def main() -> int:
    """Run mypy with the settings of pyproject.toml; returns its exit status."""
    with tempfile.TemporaryDirectory() as folder:
        package = Path(folder, "extension")
        package.mkdir()
        for part in PARTS:
            (package / part).symlink_to(ROOT / part)
        command = [sys.executable, "-m", "mypy", "--config-file", str(ROOT / "pyproject.toml")]
        command += ["--cache-dir", str(ROOT / ".mypy_cache" / "extension")]
        command += [word for part in PARTS for word in ("-p", f"extension.{part}")]
        found = subprocess.run(command, cwd=folder, text=True, stdout=subprocess.PIPE)
    print(found.stdout.replace("extension/", ""), end="")
    return found.returncode


if __name__ == "__main__":
    sys.exit(main())

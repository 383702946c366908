"""Build the site: the pages of docs/, the notebooks, and a page for each public name -> build/site/.

    python packaging/build_site.py

A link that leads nowhere, a picture that is not there, and a page in no table of contents stop it, and so does an
address outside that a page would ask for by itself: the site works from any folder, also without a network.
"""

from __future__ import annotations

import re
import shutil
import sys
from pathlib import Path

from api_reference import write_reference
from architecture import ROOT
from notebook_pages import write_notebook_pages
from sphinx.cmd.build import main as sphinx

BUILD = ROOT / "build"
SITE = BUILD / "site"
SOURCE = BUILD / "site-source"
COPIED = {".md", ".png", ".jpg", ".svg", ".gif", ".toml", ".json", ".py", ".ipynb", ".csv"}
ABOVE = re.compile(r"\]\((?:\.\./)+((?:examples/|CONTRIBUTING\.md|CHANGELOG\.md)[^)]*)(?=\))")
ASKED_FOR = re.compile(
    r"""<(?:script|img|iframe|source|video|audio)\b[^>]*\bsrc=["'](?:https?:)?//[^"']*"""
    r"""|<link\b[^>]*\bhref=["'](?:https?:)?//[^"']*|@import\s+(?:url\()?["']?(?:https?:)?//|url\(["']?(?:https?:)?//[^)]*"""
)


def gather() -> None:
    """All that the site is made of, in one folder."""
    shutil.rmtree(SOURCE, ignore_errors=True)
    for path in sorted((ROOT / "docs").rglob("*")):
        if path.suffix in COPIED and path.name != "api.md":
            _copy(path, path.relative_to(ROOT / "docs"))
    for path in sorted((ROOT / "examples").glob("*.py")):
        _copy(path, path.relative_to(ROOT))
    for name in ("CONTRIBUTING.md", "CHANGELOG.md"):
        _copy(ROOT / name, Path(name))
    write_notebook_pages(ROOT / "docs" / "notebooks", SOURCE / "notebooks")
    write_reference(SOURCE / "reference")


def _copy(path: Path, place: Path) -> None:
    """Copy a file; links of a page to files above docs/ and to notebooks lead to what the site has of them."""
    target = SOURCE / place
    target.parent.mkdir(parents=True, exist_ok=True)
    if path.suffix != ".md":
        shutil.copyfile(path, target)
        return
    up = "../" * (len(place.parts) - 1)
    text = path.read_text("utf-8").replace("](docs/", "](").replace(".ipynb)", ".md)")
    target.write_text(ABOVE.sub(lambda match: f"]({up}{match[1]}", text), "utf-8")


def outside_addresses() -> list[str]:
    """What pages of the site would load from other places."""
    pages = [path for ending in ("html", "css") for path in sorted(SITE.rglob(f"*.{ending}"))]
    asked = ((page, found) for page in pages for found in ASKED_FOR.findall(page.read_text("utf-8")))
    return [f"{page.relative_to(SITE)}: {found}" for page, found in asked]


def main() -> int:
    """Build it; 1 if a link is broken or something is asked for outside."""
    gather()
    shutil.rmtree(SITE, ignore_errors=True)
    conf = Path(__file__).parent / "site"
    words = ["-b", "html", "-c", str(conf), "-d", str(BUILD / "site-cache"), "-j", "2", "-W", "--keep-going", "-q"]
    if failed := sphinx([*words, str(SOURCE), str(SITE)]):
        return failed
    for found in (addresses := outside_addresses()):
        print(f"asks for an address outside: {found}", file=sys.stderr)
    print(f"{len(list(SITE.rglob('*.html')))} pages: {SITE / 'index.html'}")
    return int(bool(addresses))


if __name__ == "__main__":
    sys.exit(main())

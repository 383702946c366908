"""The site: every public name has a page and lines that use it, no link is broken, nothing is asked for outside."""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys

import pytest
from architecture import ROOT
from write_api_page import definition, public_packages

pytest.importorskip("sphinx", reason="the extra 'docs'")
NAMES = [(package, name) for package, names in sorted(public_packages().items()) for name in names]


@pytest.mark.slow
def test_every_public_name_has_a_page_with_lines_in_use() -> None:
    from api_reference import name_page

    without = [f"{package}.{name}" for package, name in NAMES if "rubric:: In use" not in name_page(package, name)]
    assert not without


def test_names_of_pages_differ_by_more_than_capitals() -> None:
    from api_reference import page_name

    places = [f"{package}/{page_name(package, name)}".casefold() for package, name in NAMES]
    assert len(set(places)) == len(places)


@pytest.mark.parametrize(
    ("html", "told"),
    [
        ('<script src="https://a.org/x.js">', True),
        ('<link rel="stylesheet" href="//fonts.org/a.css">', True),
        ("src: url('http://a.org/font')", True),
        ('<a href="https://arxiv.org/abs/1">', False),
        ('<img src="../a.png">', False),
    ],
)
def test_what_a_page_would_load_from_outside_is_found(html: str, told: bool) -> None:
    from build_site import ASKED_FOR

    assert bool(ASKED_FOR.search(html)) == told


@pytest.mark.slow
def test_the_site_is_built_without_a_broken_link() -> None:
    done = subprocess.run(
        [sys.executable, "packaging/build_site.py"], cwd=ROOT, capture_output=True, text=True, timeout=280,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert (ROOT / "build" / "site" / "searchindex.js").is_file()


SHAPE = re.compile(r"\(len|\((?:\.\.\.|[A-Za-z\d])[^()]*,[^()]*\)|\([A-Z]\)|\(:data:`\w+`,\)|[Ss]hapes? ")


def test_public_functions_of_arrays_say_their_shapes() -> None:
    without = []
    for package, name in NAMES:
        node, text = definition(package, name)
        if isinstance(node, ast.FunctionDef):
            arguments = [each.annotation for each in (*node.args.args, *node.args.kwonlyargs)]
            types = " ".join(ast.unparse(each) for each in (*arguments, node.returns) if each)
            if re.search("NDArray|ndarray|Floats|Ints|Bools", types) and not SHAPE.search(text):
                without.append(f"{package}.{name}")
    assert not without

"""How Sphinx makes the site; packaging/build_site.py gathers the pages and calls it."""

from __future__ import annotations

from unisg_blender import __version__

project = "UniSG for Blender"
author = "UniSG for Blender developers"
version = release = __version__

extensions = ["myst_parser"]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
myst_heading_anchors = 4
suppress_warnings = ["ref.python"]  # names that the library passes on are there twice
highlight_language = "text"
pygments_style, pygments_dark_style = "friendly", "github-dark"

html_theme = "furo"
html_title = "UniSG for Blender"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = html_show_copyright = False

"""Messages of the library in a window's words: there are fields and panels, no options of a command line."""

from __future__ import annotations

import re

SAID = (
    (r"generate without behaviour", 'untick "With actions"'),
    (r"--assets(?: FOLDER)?", 'the field "Meshes" of the import'),
    (r"--scene\b", 'the field "Scene" of the import'),
    (r" \(--[a-z][-a-z]*(?: [A-Z]+)?\)", ""),
    (r" with 'unisg export [^']*'", " in the panel Dataset"),
    (r"--([a-z][-a-z]*)(?: [A-Z]+)?", r'the choice "\1"'),
)
"""Patterns of what the command line says, and what stands for it; the first ones count first."""


def in_window(text: str) -> str:
    """A message as a user of the window understands it."""
    for pattern, words in SAID:
        text = re.sub(pattern, words, text)
    return text

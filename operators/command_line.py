"""``blender --command unisg VERB``: the command line inside Blender's own process."""

from __future__ import annotations

from typing import Any

import bpy

CLASSES = ()
_commands: list[Any] = []


def _run(argv: list[str]) -> int:
    from ..unisg_blender.cli import main

    return main(argv)


def register() -> None:
    """Offer the verbs of the command line to ``blender --command``."""
    _commands.append(bpy.utils.register_cli_command("unisg", _run))


def unregister() -> None:
    """Take the command back."""
    while _commands:
        bpy.utils.unregister_cli_command(_commands.pop())

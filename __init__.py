"""The Blender extension's entry: registers the operators and panels, nothing else."""

from __future__ import annotations


def register() -> None:
    """Enable the extension."""
    from . import operators, panels

    operators.register()
    panels.register()


def unregister() -> None:
    """Disable the extension; leaves nothing behind that would keep Blender from ending."""
    from . import operators, panels

    panels.unregister()
    operators.unregister()

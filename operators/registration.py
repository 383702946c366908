"""Register and unregister modules that have ``CLASSES`` and perhaps more."""

from __future__ import annotations

from collections.abc import Sequence
from types import ModuleType

import bpy


def register_modules(modules: Sequence[ModuleType]) -> None:
    """Register the classes of each module, then call its own ``register`` if it has one."""
    for module in modules:
        for cls in module.CLASSES:
            bpy.utils.register_class(cls)
        if hasattr(module, "register"):
            module.register()


def unregister_modules(modules: Sequence[ModuleType]) -> None:
    """Undo :func:`register_modules`, last module first."""
    for module in reversed(modules):
        if hasattr(module, "unregister"):
            module.unregister()
        for cls in reversed(module.CLASSES):
            bpy.utils.unregister_class(cls)

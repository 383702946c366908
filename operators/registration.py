"""Register and unregister modules.

Each has ``CLASSES`` and perhaps ``PROPERTIES`` (owner, name, property), ``HANDLERS``
(their list in ``bpy.app.handlers``, function), and a ``register`` and ``unregister`` of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from types import ModuleType

import bpy


def register_modules(modules: Sequence[ModuleType]) -> None:
    """Register what each module has, then call its own ``register`` if it has one."""
    for module in modules:
        for cls in module.CLASSES:
            bpy.utils.register_class(cls)
        for owner, name, prop in getattr(module, "PROPERTIES", ()):
            setattr(owner, name, prop)
        for name, handler in getattr(module, "HANDLERS", ()):
            getattr(bpy.app.handlers, name).append(handler)
        if hasattr(module, "register"):
            module.register()


def unregister_modules(modules: Sequence[ModuleType]) -> None:
    """Undo :func:`register_modules`, last module first."""
    for module in reversed(modules):
        if hasattr(module, "unregister"):
            module.unregister()
        for name, handler in getattr(module, "HANDLERS", ()):
            getattr(bpy.app.handlers, name).remove(handler)
        for owner, name, _ in getattr(module, "PROPERTIES", ()):
            delattr(owner, name)
        for cls in reversed(module.CLASSES):
            bpy.utils.unregister_class(cls)

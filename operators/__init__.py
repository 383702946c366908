"""What a user can do in Blender: properties, a library call, a report.

Each module has a tuple ``CLASSES`` and, where it keeps more than classes
(handlers, properties, drawing), its own ``register`` and ``unregister``.
"""

from __future__ import annotations

import bpy

from . import categories, command_line, forms, generate, generation_settings, label, mesh_settings, meshes, motion

MODULES: tuple = (generation_settings, generate, categories, command_line, forms, motion, mesh_settings, meshes, label)


def register() -> None:
    """Register all operators."""
    for module in MODULES:
        for cls in module.CLASSES:
            bpy.utils.register_class(cls)
        if hasattr(module, "register"):
            module.register()


def unregister() -> None:
    """Unregister all operators, last one first."""
    for module in reversed(MODULES):
        if hasattr(module, "unregister"):
            module.unregister()
        for cls in reversed(module.CLASSES):
            bpy.utils.unregister_class(cls)

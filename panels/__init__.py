"""What a user sees in the sidebar: drawing only.

Each module has a tuple ``CLASSES`` and, where it keeps more than classes, its
own ``register`` and ``unregister``. Sub-panels name ``UNISG_PT_main`` as parent.
"""

from __future__ import annotations

import bpy

from . import forms, generate, main, meshes, motion

MODULES: tuple = (main, generate, forms, motion, meshes)


def register() -> None:
    """Register all panels."""
    for module in MODULES:
        for cls in module.CLASSES:
            bpy.utils.register_class(cls)
        if hasattr(module, "register"):
            module.register()


def unregister() -> None:
    """Unregister all panels, last one first."""
    for module in reversed(MODULES):
        if hasattr(module, "unregister"):
            module.unregister()
        for cls in reversed(module.CLASSES):
            bpy.utils.unregister_class(cls)

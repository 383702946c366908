"""What a user sees in the sidebar: drawing only.

Each module has a tuple ``CLASSES`` and, where it keeps more than classes, its
own ``register`` and ``unregister``. Sub-panels derive from :class:`~.main.SubPanel`.
"""

from __future__ import annotations

from ..operators.registration import register_modules, unregister_modules
from . import (
    batches,
    building_overlay,
    check,
    export,
    forms,
    generate,
    lesson,
    main,
    menus,
    meshes,
    motion,
    object_actions,
    overlay,
    placing_overlay,
    recognised_building,
    recording,
    relations,
    suggest,
    where_from,
)

MODULES = (
    menus,
    main,
    generate,
    where_from,
    suggest,
    check,
    recognised_building,
    building_overlay,
    placing_overlay,
    meshes,
    lesson,
    object_actions,
    overlay,
    export,
    batches,
    recording,
    relations,
    forms,
    motion,
)


def register() -> None:
    """Register all panels."""
    register_modules(MODULES)


def unregister() -> None:
    """Unregister all panels."""
    unregister_modules(MODULES)

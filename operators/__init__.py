"""What a user can do in Blender: properties, a library call, a report.

Each module has a tuple ``CLASSES`` and, where it keeps more than classes
(handlers, properties, drawing), its own ``register`` and ``unregister``.
"""

from __future__ import annotations

from . import (
    action_properties,
    actions,
    categories,
    classify,
    command_line,
    convert,
    copy_repair,
    export,
    forms,
    label,
    lesson,
    lesson_properties,
    mesh_settings,
    meshes,
    motion,
    play,
    preferences,
    recording,
    relations,
    scene_lookup,
)
from .interchange import gltf_lesson, import_layout, play_in_browser
from .making import add_room, generate, generation_settings, lock, reroll, settle, suggest, understand
from .many import batch_work, labelled_pictures, variations
from .placing import choose_and_place, place, place_tool
from .registration import register_modules, unregister_modules
from .room import checking, corrections, recognised
from .shapes import chosen_shapes, library_index, look_through

MODULES = (
    preferences,
    scene_lookup,
    recognised,
    corrections,
    checking,
    chosen_shapes,
    library_index,
    look_through,
    add_room,
    generation_settings,
    generate,
    suggest,
    place,
    choose_and_place,
    place_tool,
    reroll,
    lock,
    understand,
    settle,
    categories,
    command_line,
    forms,
    motion,
    mesh_settings,
    meshes,
    label,
    export,
    batch_work,
    variations,
    labelled_pictures,
    action_properties,
    actions,
    lesson_properties,
    lesson,
    play,
    copy_repair,
    convert,
    import_layout,
    gltf_lesson,
    play_in_browser,
    relations,
    classify,
    recording,
)


def register() -> None:
    """Register all operators."""
    register_modules(MODULES)


def unregister() -> None:
    """Unregister all operators."""
    unregister_modules(MODULES)

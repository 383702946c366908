"""The Blender extension's entry: registers the operators and panels, and takes part in glTF exports."""

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


def glTF2ExportUserExtension() -> object:
    """What takes part when Blender exports glTF."""
    from .operators.interchange.gltf_lesson import LessonExtension

    return LessonExtension()


def draw_export(context: object, layout: object) -> None:
    """Our box among the settings of Blender's glTF exporter."""
    from .panels.gltf_export_box import draw_box

    draw_box(context, layout)

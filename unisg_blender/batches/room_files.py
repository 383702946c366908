"""Write rooms as files; a Blender file keeps what the scenegraph does not hold."""

from __future__ import annotations

from pathlib import Path

from ..formats.scene_files import opened_by_blender, write_scene_file
from ..runtime.file_endings import is_of
from .made_room import MadeRoom


def write_room(room: MadeRoom, path: Path) -> None:
    """Write a room in the kind that the path's ending names, whole or not at all.

    Raises
    ------
    UniSGError
        If the file cannot be written.
    """
    if not is_of(path, (".blend",)):
        write_scene_file(room.scene, path)
        return
    from ..blender import save_blend

    open_room(room)
    save_blend(path)


def open_room(room: MadeRoom) -> None:
    """Make a room the scene that is open in Blender; one out of a Blender file keeps what its scenegraph does not hold.

    Raises
    ------
    UniSGError
        If that file cannot be opened any more.
    """
    from ..blender import open_file, write_rows
    from ..blender.authoring.changed_objects import bring_behaviour, move_objects, remove_objects
    from ..blender.authoring.extended_lessons import extend_lessons
    from ..blender.blend_files import current_scene, new_scene

    if room.base is None or not opened_by_blender(room.base):
        new_scene(room.scene)
        return
    open_file(room.base)
    remove_objects(room.gone, current_scene())
    move_objects(room.scene, room.moved, current_scene())
    if room.changed:
        bring_behaviour(room.scene, room.new.tolist(), current_scene())
    extend_lessons(room.scene, room.new.tolist(), current_scene())
    write_rows(room.scene, room.new, current_scene())

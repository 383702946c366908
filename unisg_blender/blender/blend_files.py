"""Open and save files through Blender; scripts inside opened files never run."""

from __future__ import annotations

import contextlib
import os
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import addon_utils
import bpy

from ..errors import UNFORESEEN, UniSGError, did_you_mean, unforeseen
from ..runtime.atomic_files import replacing
from ..runtime.file_endings import BLENDER, USD
from ..runtime.guarded_work import EVALUATED, still_reading
from ..runtime.output_capture import captured_output, heard
from ..runtime.read_report import ReadReport
from ..runtime.wording import some_of
from ..scene.graph import SceneGraph
from .read.scene_reader import Geometry, read_scene, read_scenes
from .readable_names import make_names_readable
from .scene_frames import cover_keys, set_frame_range
from .write.scene_writer import write_scene

SUFFIXES = (*BLENDER, *USD)
"""Endings of the files that Blender reads."""

TALKATIVE = (".obj", ".fbx")  # their importers take anything and finish
WARNING = re.compile(r"^(?:\d\d:\d\d:\d\d \| )?(?:WARN\w*|Warning|ERROR|Error)\b(?: \([\w.]+\))?:?\s*(.*)$")
SOURCE_PLACE = re.compile(r"^\S+\.(?:cc|cpp|c|h):\d+ \w+: ")
KEPT_WARNINGS = 20
BLENDER_VERSION = bpy.app.version_string


def open_file(path: str | os.PathLike[str], report: ReadReport | None = None) -> None:
    """Open a scene file in Blender in place of what is open now (unsaved work is lost).

    Parameters
    ----------
    path
        A file of one of :data:`SUFFIXES`; all but .blend go through Blender's importers.
    report
        Is told the warnings of the importer.

    Raises
    ------
    UniSGError
        If the file is missing, damaged, empty or of another kind. Blender is left empty then.
    """
    path = Path(path)
    _check_path(path)
    with captured_output() as printed:
        error = _open_quietly(path.absolute())  # Blender resolves paths against PWD
    if error is None and path.suffix.lower() in TALKATIVE and not bpy.data.objects:
        error = "there are no objects in it"
    if error is not None:
        with captured_output():
            new_file()
        names = "|".join(re.escape(name) for name in sorted({str(path), str(path.absolute())}, key=len, reverse=True))
        reason = re.sub(rf"""\s*(?:in file )?['"]?(?:{names})['"]?""", "", error)
        raise UniSGError(f"cannot read {path}: {reason}; is it damaged, or of another kind?")
    still_reading(EVALUATED)
    if report is not None:
        for line in _warnings(printed):
            report.add("", line)
        if not bpy.data.objects:
            report.add("", "there are no objects in the file")


def read_file(
    path: str | os.PathLike[str],
    *,
    geometry: Geometry = "evaluated",
    details: bool = True,
    animation: bool = False,
    scene: str = "",
    progress: Callable[[int, int], None] | None = None,
) -> tuple[SceneGraph, ReadReport]:
    """Open a file and read its current scene, or the one that is named ``scene``.

    The other arguments are those of :func:`~.read.scene_reader.read_scene`.

    Returns
    -------
    graph, report
        The scenegraph, and what it could not represent, object by object.

    Raises
    ------
    UniSGError
        As :func:`open_file`, and if there is no such scene.
    """
    report = ReadReport()
    open_file(path, report)
    found = bpy.data.scenes.get(scene) if scene else bpy.context.scene
    if found is None:
        names = [each.name for each in bpy.data.scenes]
        there = some_of(map(repr, names), 9)
        raise UniSGError(f"{path}: there is no scene {scene!r}{did_you_mean(scene, names)}; there are {there}")
    tell = None if progress is None else heard(progress)
    with captured_output(), _expected_sound(path):
        graph = read_scene(found, geometry=geometry, details=details, animation=animation, report=report, progress=tell)
    others = [each.name for each in bpy.data.scenes if each != found]
    if others:
        report.add("", f"only the scene {found.name!r} is read; the others are {', '.join(map(repr, others))}")
    return graph, report


def read_all_scenes(path: str | os.PathLike[str]) -> tuple[list[SceneGraph], ReadReport]:
    """Open a file and read all its scenes; errors are those of :func:`open_file`."""
    report = ReadReport()
    open_file(path, report)
    with captured_output(), _expected_sound(path):
        return list(read_scenes(report=report).values()), report


@contextlib.contextmanager
def _expected_sound(path: str | os.PathLike[str]) -> Iterator[None]:
    """Refuse a file of which parts do not fit together, as in no file that Blender itself has saved."""
    try:
        yield
    except UniSGError as error:
        raise UniSGError(f"cannot read {path}: {error}") from None
    except UNFORESEEN as error:
        raise unforeseen(path, "Blender", error) from error


def current_scene() -> bpy.types.Scene:
    """The scene that is open."""
    return bpy.context.scene


def linked_files() -> list[Path]:
    """The libraries and caches that the open file refers to."""
    names = [bpy.path.abspath(item.filepath, library=item.parent) for item in bpy.data.libraries]
    names += [bpy.path.abspath(item.filepath, library=item.library) for item in bpy.data.cache_files]
    return [Path(os.path.normpath(name)) for name in names]


def new_file() -> None:
    """An empty Blender file without objects."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)


def save_blend(path: str | os.PathLike[str]) -> None:
    """Save everything that is open as a .blend file; the file is complete or is not written at all.

    Raises
    ------
    UniSGError
        If the place cannot be written.
    """
    with replacing(Path(path).absolute()) as unfinished, captured_output():
        try:
            bpy.ops.wm.save_as_mainfile(filepath=str(unfinished), copy=True, check_existing=False)
        except RuntimeError as error:
            raise UniSGError(f"cannot write {path}: {_last_line(str(error))}") from None


def new_scene(graph: SceneGraph, report: ReadReport | None = None) -> None:
    """Open a new file whose only scene is the scenegraph; ``report`` is told what Blender cannot hold."""
    new_file()
    current_scene().name = graph.title
    set_frame_range(graph, current_scene(), ReadReport() if report is None else report)
    write_scene(graph, current_scene(), report=report)


def write_blend(graph: SceneGraph, path: str | os.PathLike[str]) -> ReadReport:
    """Write a scenegraph as a .blend file, in place of what is open; returns what Blender could not hold.

    Raises
    ------
    UniSGError
        As :func:`save_blend`.
    """
    report = ReadReport()
    new_scene(graph, report)
    save_blend(path)
    return report


def _check_path(path: Path) -> None:
    if path.suffix.lower() not in SUFFIXES:
        raise UniSGError(f"cannot read {path}: the known kinds of file are {', '.join(SUFFIXES)}")
    if not path.is_file():
        raise UniSGError(f"cannot read {path}: " + ("it is a folder" if path.is_dir() else "there is no such file"))
    if path.stat().st_size == 0:
        raise UniSGError(f"cannot read {path}: the file is empty")
    if not os.access(path, os.R_OK):
        raise UniSGError(f"cannot read {path}: no permission")


def _open_quietly(path: Path) -> str | None:
    """What went wrong, or None."""
    try:
        if path.suffix.lower() == ".blend":
            bpy.ops.wm.open_mainfile(filepath=str(path), use_scripts=False, load_ui=False)
            make_names_readable()
            return None
        new_file()
        result = _importer(path.suffix.lower())(filepath=str(path))
        cover_keys(bpy.context.scene)
    except RuntimeError as error:  # an operator that reports an error
        return _last_line(str(error))
    return None if "FINISHED" in result else "Blender's importer gave up"


def _importer(suffix: str) -> Callable[..., set[str]]:
    if suffix in (".glb", ".gltf"):
        _enable("io_scene_gltf2")
        return bpy.ops.import_scene.gltf
    if suffix == ".fbx":
        _enable("io_scene_fbx")
        return bpy.ops.import_scene.fbx
    return bpy.ops.wm.obj_import if suffix == ".obj" else bpy.ops.wm.usd_import


def _enable(addon: str) -> None:
    if not addon_utils.check(addon)[1]:
        addon_utils.enable(addon, default_set=False)


def _last_line(text: str) -> str:
    """The line of an operator's error that says what is wrong: Python's tracebacks have it last."""
    lines = [line.strip() for line in text.splitlines() if line.strip() and not line.startswith("Location:")]
    line = (lines[-1] if "Traceback" in text else lines[0]) if lines else "Blender does not say why"
    return line.removeprefix("Error: ")


def _warnings(printed: list[str]) -> list[str]:
    found = [match[1] for line in printed if (match := WARNING.match(line.strip())) and match[1]]
    lines = list(dict.fromkeys(SOURCE_PLACE.sub("", line) for line in found))
    return lines[:KEPT_WARNINGS] + [f"{len(lines) - KEPT_WARNINGS} more warnings"] * (len(lines) > KEPT_WARNINGS)

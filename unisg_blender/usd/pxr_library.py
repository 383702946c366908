"""Where Pixar's ``pxr`` comes from: Blender's own inside Blender, ``usd-core`` elsewhere."""

from __future__ import annotations

import sys
from importlib import import_module
from importlib.util import find_spec

from ..errors import MissingPackageError, UniSGError
from ..runtime.process_end import signals_kept


def missing_pxr() -> str:
    """Why USD files cannot be read or written here, "" if they can: for grey buttons."""
    try:
        require_pxr()
    except UniSGError as error:
        return str(error)
    return ""


def require_pxr() -> None:
    """Make ``import pxr`` work.

    The two builds cannot live in one process, so a process with ``bpy`` uses
    Blender's, and so does one where there is no ``usd-core``; a process that will
    open Blender files as well must import ``bpy`` before its first USD file.

    Raises
    ------
    UniSGError
        If this Blender has no USD modules for Python.
    MissingPackageError
        If there is no Blender and ``usd-core`` is not installed.
    """
    if "pxr.Usd" in sys.modules:
        return
    bpy = sys.modules.get("bpy")
    if bpy is None and not find_spec("pxr") and find_spec("bpy"):  # Blender as a package, and no usd-core
        import_module("..blender", __package__)
        bpy = sys.modules["bpy"]
    if bpy is not None:
        if not hasattr(bpy.utils, "expose_bundled_modules"):
            raise UniSGError("this Blender offers no USD to Python: use Blender 4.4 or newer for USD files")
        bpy.utils.expose_bundled_modules()
    try:
        with signals_kept():
            from pxr import Usd  # noqa: F401
    except ImportError:
        raise MissingPackageError("usd-core", "usd") from None

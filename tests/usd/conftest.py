"""Blender comes first: it brings its own USD, which cannot share a process with ``usd-core``."""

from __future__ import annotations

import contextlib

with contextlib.suppress(ImportError):
    import bpy  # noqa: F401

from unisg_blender.usd.pxr_library import missing_pxr

if missing_pxr():  # Blender before 4.4, or neither Blender nor usd-core
    collect_ignore_glob = ["*"]

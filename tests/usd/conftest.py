"""Blender comes first: it brings its own USD, which cannot share a process with ``usd-core``."""

from __future__ import annotations

import contextlib

with contextlib.suppress(ImportError):
    import bpy  # noqa: F401

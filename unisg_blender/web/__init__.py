"""Lessons in a browser: a folder, or a single page, that any static host serves."""

from __future__ import annotations

from .site import write_page, write_site

__all__ = ["write_page", "write_site"]

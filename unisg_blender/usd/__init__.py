"""The USD master file: geometry, hierarchy, categories, behaviour and recordings of one scene."""

from __future__ import annotations

from .usd_files import read_usd, write_usd

__all__ = ["read_usd", "write_usd"]

"""Small rooms to learn from."""

from __future__ import annotations

from tests.generate.conftest import dataset_folder

__all__ = ["dataset_folder"]

"""Rooms in batches: made by many processes or machines, resumable, with a report of each."""

from __future__ import annotations

from .batch_plan import BatchOptions, plan_rooms
from .batch_run import batch_steps, make_batch
from .made_room import MadeRoom

__all__ = ["BatchOptions", "MadeRoom", "batch_steps", "make_batch", "plan_rooms"]

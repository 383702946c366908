"""A room that was made: its scenegraph, where it comes from, and what is said of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ..geometry.arrays import Ints
from ..scene import SceneGraph


@dataclass(frozen=True, eq=False)
class MadeRoom:
    """A room that was made.

    Attributes
    ----------
    scene
        The room.
    record
        What is said of it in the report, JSON-ready.
    label
        Which kind of scene it is.
    base
        The file that it grew out of, None for none.
    new
        Rows of the scene that are new in it; of a ``base`` that Blender reads, all others stand there.
    gone, moved
        uids of what the base has and the room has not, and of what stands elsewhere in it.
    changed
        Whether actions, lessons and relations of what stands in the base may be others, too.
    """

    scene: SceneGraph
    record: dict[str, Any]
    label: str = ""
    base: Path | None = None
    new: Ints = field(default_factory=lambda: np.zeros(0, np.int64))
    gone: tuple[str, ...] = ()
    moved: tuple[str, ...] = ()
    changed: bool = False


Maker = Callable[[Mapping[str, Any], Mapping[str, Any]], MadeRoom]
"""Makes the room of a task (see :mod:`.batch_plan`) with some settings."""

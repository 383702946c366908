"""What became of one object that was asked for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ...geometry.arrays import Floats


@dataclass(frozen=True, eq=False)
class Placement:
    """What became of one object that was asked for.

    Attributes
    ----------
    category, name, uid
        What it is; name and uid are "" if it was refused.
    support
        Name of what it stands on or hangs from, "" for the ground.
    world
        Its matrix in the world (4, 4), None if it was refused.
    collision
        Metres by which it reaches into something, beyond what is usual; 0 after settling.
    draws
        Proposals looked at.
    searched
        True if no proposal fitted and the free place nearest to the first one was taken.
    milliseconds
        Time for this object.
    note
        What should be known: why it was refused, which usual support is missing, which actions could not be made.
    actions
        Names of the new actions that it takes part in.
    source
        What its shape was made of, see :class:`~...dataset.assets.asset.Asset`.
    """

    category: str
    name: str = ""
    uid: str = ""
    support: str = ""
    world: Floats | None = None
    collision: float = 0.0
    draws: int = 0
    searched: bool = False
    milliseconds: float = 0.0
    note: str = ""
    actions: tuple[str, ...] = ()
    source: str = ""

    @property
    def refused(self) -> bool:
        """Nothing was added."""
        return self.world is None

    def to_record(self) -> dict[str, Any]:
        """JSON-ready."""
        world = None if self.world is None else self.world.round(6).tolist()
        changed = {"world": world, "actions": list(self.actions), "milliseconds": round(self.milliseconds, 2)}
        told = {name: value for name, value in self.__dict__.items() if name != "source"}
        return {**told, **changed, "refused": self.refused}

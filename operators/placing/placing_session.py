"""What is being placed in a window: the room as it is known, where one points, and the ghost that stands there.

No Blender object is held; the room is looked at in the background, and lengths are metres.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ...unisg_blender.errors import UniSGError
from ..base import redraw_views
from ..making.generation_settings import opened_generator, scene_in_words
from ..room.background import Background

if TYPE_CHECKING:
    from ...unisg_blender.dataset.assets.asset import Asset
    from ...unisg_blender.generate.pointing.ghosts import Ghost
    from ...unisg_blender.generate.pointing.placing_room import PlacingRoom
    from ...unisg_blender.scene import SceneGraph
    from .pointed_at import Pointed

LOOKING = "Looking at the room ..."
NOWHERE = "no likely place near here"
STILL = 0.15
"""Seconds without a move after which it is measured by how much something is wrong."""


@dataclass(frozen=True)
class PlacingChoice:
    """What is placed, by whose model (a file): a category in its ``shape``-th form, the first of which are ``shapes``,
    or the object ``source`` of the scene, or an ``asset``; with the words of a mapping file, and the object ``on`` or
    ``beside`` which it is wanted."""

    model: str
    category: str = ""
    source: str = ""
    asset: Asset | None = None
    shapes: tuple[Asset, ...] = ()
    shape: int = 0
    words: dict[str, dict[str, str]] | None = None
    on: str = ""
    beside: str = ""
    seed: int = 0
    variety: float = 1.0


def look_at_room(
    graph: SceneGraph, choice: PlacingChoice, near: tuple[float, float, float] | None, before: PlacingRoom | None = None
) -> PlacingRoom:
    """What is known of a scene before one points; touches nothing of Blender's.

    Raises
    ------
    UniSGError
        If nobody knows what the thing is, or where it is wanted.
    """
    from ...unisg_blender.dataset.assets.asset import object_graph
    from ...unisg_blender.generate.pointing.placing_room import PlacingRoom, Wanted
    from ...unisg_blender.spatial.object_rows import object_rows

    generator, words = opened_generator(choice.model), (choice.words or {}).get("words", {})
    wanted = Wanted(choice.category, choice.shape, None, choice.on, choice.beside, choice.shapes)
    if choice.source:
        if choice.source not in graph.name:
            raise UniSGError(f"{choice.source!r} is not in the scene: choose an object of it")
        read = generator.seen(graph, words)
        row = int(object_rows(read)[graph.name.index(choice.source)])
        if row < 0:
            raise UniSGError(f"{choice.source!r} shows nothing that could be placed: choose an object with a mesh")
        category = choice.category or read.category_name(row)
        if not category:
            raise UniSGError(f"what is {choice.source!r}? Assign it a category first")
        wanted = replace(wanted, category=category, asset=object_graph(read, row))
    if choice.asset is not None:
        thing = choice.asset.graph
        category = choice.category or generator.seen(thing, words).category_name(0)
        if not category:
            raise UniSGError(f"what is {thing.name[0]!r}? Give a category, or call it by a word for a thing")
        wanted = replace(wanted, category=category, asset=replace(choice.asset, category=category))
    point = None if near is None else np.array(near)
    return PlacingRoom.of(generator, graph, wanted, point, words, choice.seed, before)


class Placing:
    """One thing after another is placed in a scene."""

    def __init__(self, scene: bpy.types.Scene, choice: PlacingChoice, behaviour: bool) -> None:
        from ...unisg_blender.blender.scene_units import metres_per_unit

        self.scene, self.choice, self.behaviour = scene.name, choice, behaviour
        self.metres = metres_per_unit(scene)
        self.graph: SceneGraph | None = None
        self.room: PlacingRoom | None = None
        self.ghost: Ghost | None = None
        self.pointed: Pointed | None = None
        self.number = 0
        self.yaw: float | None = None
        self.locked, self.drawn = False, False
        self.mouse, self.region = (0, 0), 0
        self.text, self.failed = LOOKING, ""
        self._rng = np.random.default_rng()
        self._looking: Background[PlacingRoom] = Background()
        self._measuring: Background[Ghost] = Background()
        self._again = False
        self._still = self._measure  # Blender knows a timer by the very object, and a method is another one each time

    def look(self, anew: bool = False) -> None:
        """Look at the room in the background: at a new state of the scene, if it is ``anew``."""
        if self._looking.busy:
            self._again, self.graph = True, None if anew else self.graph
            return
        if anew or self.graph is None:
            self.graph, self.room = scene_in_words(bpy.data.scenes[self.scene], self.choice.words or {}), None
        graph, choice, before = self.graph, self.choice, self.room
        near = None if self.pointed is None else self.pointed.point
        self.ghost, self.text = None, LOOKING
        self._looking.start(lambda: look_at_room(graph, choice, near, before), self._known, self._unknown)

    def _known(self, room: PlacingRoom) -> None:
        self.room, self.text, self.failed = room, "", ""
        if self._again or room.graph is not self.graph:
            self._again = False
            self.look()
            return
        self.update()

    def _unknown(self, text: str) -> None:
        self.room, self.ghost, self.text, self.failed = None, None, text, text

    def point_at(self, pointed: Pointed | None) -> None:
        """Where the mouse is; places that were gone through there, and what was drawn by chance, are left."""
        self.number, self.drawn, self.pointed = 0, False, pointed
        if self.room is not None and pointed is not None and not self.room.has(np.array(pointed.point)):
            self.look()  # another room of the house
        else:
            self.update()

    def next_place(self, step: int) -> None:
        """Another likely place near the mouse."""
        self.number, self.yaw, self.drawn = self.number + step, None, False
        self.update()

    def turn_by(self, angle: float) -> None:
        """Turned by hand it stands at the very point, and keeps its turn until another likely place is asked for."""
        usual = 0.0 if self.ghost is None else float(self.ghost.place[3])
        self.yaw, self.drawn = (usual if self.yaw is None else self.yaw) + angle, False
        self.update()

    def other_shape(self) -> None:
        """The next shape."""
        self.choice = replace(self.choice, shape=self.choice.shape + 1)
        self.look()

    def draw_anew(self) -> None:
        """A place of the room by chance, until the mouse is moved."""
        from ...unisg_blender.generate import Sampling
        from ...unisg_blender.generate.pointing.ghosts import ghost_anywhere

        if self.room is not None:
            self.ghost, self.drawn = ghost_anywhere(self.room, self._rng, Sampling(self.choice.variety)), True
            self.text = "" if self.ghost else NOWHERE
            self._measure_soon()

    def update(self) -> None:
        """Put the ghost where it belongs now."""
        from ...unisg_blender.generate.pointing.ghosts import ghost_by_hand, ghost_near

        if self.room is None or self.pointed is None or self._looking.busy:
            self.ghost = None
            return
        point = np.array(self.pointed.point)
        self.ghost = None if self.yaw is not None else ghost_near(self.room, point, self.number)
        self.text = ""
        if self.ghost is None:
            self.ghost = ghost_by_hand(self.room, point, self.yaw, self.pointed.level)
            self.text = NOWHERE if self.yaw is None else ""
        self._measure_soon()

    def lines(self) -> list[str]:
        """What is said beside the ghost."""
        if self.room is None or self.ghost is None:
            return [self.text] if self.text else []
        name = self.room.wanted.category
        found = [f"{name}: {line}" for line in self.ghost.wrong] or [f"{name}: fits"]
        return found + [line for line in (self.text, self.ghost.note, "locked" if self.locked else "") if line]

    def _measure_soon(self) -> None:
        if bpy.app.timers.is_registered(self._still):
            bpy.app.timers.unregister(self._still)
        if self.ghost is not None and not bpy.app.background:
            bpy.app.timers.register(self._still, first_interval=STILL)

    def _measure(self) -> None:
        """Measure in the background by how much something is wrong, and look whether there is still a way."""
        from ...unisg_blender.generate.pointing.ghosts import measured

        room, ghost = self.room, self.ghost
        if room is None or ghost is None or self._measuring.busy:
            return

        def told(found: Ghost) -> None:
            """Say it, unless it is another place by now."""
            if self.ghost is ghost:
                self.ghost = found
                redraw_views(bpy.context)

        self._measuring.start(lambda: measured(room, ghost), told, lambda text: None)

    def end(self) -> None:
        """Let go of what goes on in the background."""
        if bpy.app.timers.is_registered(self._still):
            bpy.app.timers.unregister(self._still)
        self._looking.end()
        self._measuring.end()


_placing: list[Placing] = []


def placing() -> Placing | None:
    """What is being placed, None where nothing is."""
    return _placing[-1] if _placing else None


def begin_placing(new: Placing) -> None:
    """Start; what was placed before ends."""
    end_placing()
    _placing.append(new)


def end_placing() -> None:
    """Leave nothing behind, nor its keys in the status bar."""
    if _placing:
        for window in bpy.context.window_manager.windows:
            window.workspace.status_text_set(None)
    while _placing:
        _placing.pop().end()

"""What is building in a scene, recognised in the background; panels and the overlay ask for what is known of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import bpy
from bpy.app.handlers import persistent

from ...unisg_blender.errors import UniSGError
from ..base import redraw_views
from ..window_wording import in_window
from .background import Background
from .structure_shapes import StructureShapes, structure_shapes

if TYPE_CHECKING:
    from ...unisg_blender.scene import SceneGraph
    from ...unisg_blender.spatial.structure import Structure
    from ...unisg_blender.spatial.structure.room_things import RoomName

QUIET = 0.6
"""Seconds without a change after which a scene is looked at again."""


@dataclass(frozen=True, eq=False)
class Recognised:
    """The structure of a scene in metres, what each room is, and how many of the scene's units are a metre."""

    graph: SceneGraph
    structure: Structure
    names: tuple[RoomName, ...]
    units: float

    @cached_property
    def row_of_name(self) -> dict[str, int]:
        """The rows of the entities by their names, which are unique in Blender."""
        return {name: row for row, name in enumerate(self.graph.name)}

    @cached_property
    def shapes(self) -> StructureShapes:
        """What is drawn of it."""
        return structure_shapes(self.structure, self.room_lines(), self.units)

    def room_lines(self) -> list[str]:
        """A short line for each room."""
        lines = []
        for number, (room, name) in enumerate(zip(self.structure.rooms, self.names, strict=True)):
            kind = name.label or ("room" if room.indoors else "open place")
            lines.append(f"{number}: {kind}, {room.area:.1f} m2")
        return lines

    @property
    def summary(self) -> str:
        """All in a line."""
        from ...unisg_blender.spatial.structure.structure_text import count_text

        rooms, floors = self.structure.rooms, self.structure.storeys
        openings = sum(len(room.openings) for room in rooms)
        if not rooms:
            return " ".join(self.structure.notes)
        storeys = f" on {_many(floors, 'storey')}" if floors > 1 else ""
        held = _many(len(self.structure.surfaces), "surface")
        return f"{count_text(self.structure)}{storeys}, {_many(openings, 'opening')}, {held} for things"


def _many(count: int, word: str) -> str:
    return f"{count} {word}{'s' * (count != 1)}"


@dataclass
class Known:
    """What is known of scenes, by name, why nothing is, and which ones are to be looked at, first come first."""

    scenes: dict[str, Recognised] = field(default_factory=dict)
    problems: dict[str, str] = field(default_factory=dict)
    asked: dict[str, None] = field(default_factory=dict)


_known = Known()
_background: Background[Recognised] = Background()  # `Background[...]()` would be kept by typing, and Blender not end


def recognised(scene: bpy.types.Scene) -> Recognised | None:
    """What is known of a scene, None where nobody has looked yet."""
    return _known.scenes.get(scene.name)


def looking() -> bool:
    """Whether a scene is being looked at."""
    return _background.busy or bpy.app.timers.is_registered(_begin)


def problem(scene: bpy.types.Scene) -> str:
    """Why nothing is known of a scene, "" where nothing went wrong."""
    return _known.problems.get(scene.name, "")


def recognise_now(scene: bpy.types.Scene) -> Recognised:
    """Look at a scene and wait for it."""
    found = _look(_read(scene), _units(scene))
    _keep(scene.name, found)
    return found


def _keep(name: str, found: Recognised) -> None:
    _ = found.shapes  # made here: nothing is computed while the viewport draws
    _known.scenes[name] = found
    _known.problems.pop(name, None)


def recognise_soon(scene: bpy.types.Scene, delay: float = 0.01) -> None:
    """Look at a scene in the background, when nothing has changed for so many seconds."""
    if bpy.app.background:
        return
    _known.asked[scene.name] = None
    if bpy.app.timers.is_registered(_begin):
        bpy.app.timers.unregister(_begin)
    bpy.app.timers.register(_begin, first_interval=delay)


def _read(scene: bpy.types.Scene) -> SceneGraph:
    from ...unisg_blender.blender import read_scene

    return read_scene(scene, details=False)


def _units(scene: bpy.types.Scene) -> float:
    from ...unisg_blender.blender.scene_units import metres_per_unit

    return 1.0 / metres_per_unit(scene)


def _look(graph: SceneGraph, units: float) -> Recognised:
    from ...unisg_blender.generate.observe.named_rooms import room_names
    from ...unisg_blender.spatial.structure import recognise_structure

    structure = recognise_structure(graph)
    return Recognised(graph, structure, room_names(structure, graph), units)


def _begin() -> None:
    """Look at the first scene that waits, unless one is being looked at: a timer does not know in which window."""
    scenes = [bpy.data.scenes[name] for name in _known.asked if name in bpy.data.scenes]
    if _background.busy or not scenes:
        return
    name = scenes[0].name
    del _known.asked[name]

    def done(found: Recognised) -> None:
        """Keep it, and go on with what waits."""
        _keep(name, found)
        _begin()

    def failed(text: str) -> None:
        """Tell it, and go on with what waits."""
        _known.problems[name] = text
        _begin()

    try:
        graph, units = _read(scenes[0]), _units(scenes[0])
    except UniSGError as error:
        failed(in_window(str(error)))
    else:
        _background.start(lambda: _look(graph, units), done, failed)


def wanted() -> bool:
    """Whether anybody looks at what is recognised, so that it is to be kept up to date."""
    return bool(bpy.context.window_manager.unisg_structure_shown)


@persistent
def _changed(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph | None = None) -> None:
    if not wanted() or depsgraph is None:
        return
    if any(update.is_updated_geometry or update.is_updated_transform for update in depsgraph.updates):
        recognise_soon(scene, QUIET)


@persistent
def _undone(*_: object) -> None:
    if wanted():
        recognise_soon(bpy.context.scene, QUIET)


@persistent
def _loaded(*_: object) -> None:
    _forget()
    _undone()


def _forget() -> None:
    _background.end()
    for known in (_known.scenes, _known.problems, _known.asked):
        known.clear()


def _switched(manager: bpy.types.WindowManager, context: bpy.types.Context) -> None:
    if manager.unisg_structure_shown:
        recognise_soon(context.scene)
    redraw_views(context)


CLASSES = ()
HANDLERS = (
    ("depsgraph_update_post", _changed), ("undo_post", _undone), ("redo_post", _undone), ("load_post", _loaded),
)  # fmt: skip
PROPERTIES = (
    (bpy.types.WindowManager, "unisg_structure_shown", bpy.props.BoolProperty(
        name="Show in Viewport", default=False, options={"SKIP_SAVE"}, update=_switched,
        description="Draw the rooms that are recognised, with what they are, doors, windows and surfaces for things",
    )),
)  # fmt: skip


def unregister() -> None:
    """Forget what is known."""
    if bpy.app.timers.is_registered(_begin):
        bpy.app.timers.unregister(_begin)
    _forget()

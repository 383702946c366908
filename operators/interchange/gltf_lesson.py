"""The lesson in what Blender's own glTF exporter writes: its behaviour graph, and what is ours as extras.

Blender asks enabled add-ons for a class ``glTF2ExportUserExtension``, whose hooks it calls while it exports.
Source: the manual of glTF-Blender-IO, "Third-party glTF Extensions".
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import bpy

from ...unisg_blender.errors import UniSGError
from ..scene_lookup import SceneLookup, looked_up
from ..window_wording import in_window

if TYPE_CHECKING:
    from ...unisg_blender.scene import SceneGraph

WANTED = "unisg_gltf_lesson"
UP = "its axes are not glTF's: tick +Y Up"
UNIT = "its unit is not the metre, and Blender's exporter writes numbers as they are: set Unit Scale to 1"
TURNED = "CAMERA", "LIGHT"
"""Types of objects that Blender's exporter turns, since glTF's cameras and lights look along other axes."""

_told: list[tuple[SceneLookup, list[str]]] = []


def not_carried(scene: bpy.types.Scene) -> list[str]:
    """What a file cannot carry of a scene's lessons, or says otherwise; looked up once until the scene changes."""
    found = looked_up(scene)
    if not _told or _told[0][0] is not found:
        _told[:] = [(found, list(_losses(scene)))]
    return _told[0][1]


def left_out(scene: bpy.types.Scene, exporter: Any) -> list[str]:
    """What the exporter's settings leave out of a lesson."""
    from ...unisg_blender.blender.lookup import objects_by_uid

    lines = [] if getattr(exporter, "export_yup", True) else [f"the lesson: {UP}"]
    if getattr(exporter, "use_selection", False):
        objects = objects_by_uid(scene)
        about = {uid for action, _ in looked_up(scene).actions.values() for uid in _about(action)}
        names = sorted(objects[uid].name for uid in about if uid in objects and not objects[uid].select_get())
        lines += [f"{name}: it is not selected, and the lesson is about it" for name in names]
    return lines


def _about(action: Any) -> tuple[str, ...]:
    return (*action.targets, *action.tools, *([action.frame] if action.frame else []))


def _losses(scene: bpy.types.Scene) -> Iterator[str]:
    from ...unisg_blender.blender import read_scene
    from ...unisg_blender.blender.scene_units import metres_per_unit
    from ...unisg_blender.formats.gltf.gltf_lessons import playable_lessons
    from ...unisg_blender.runtime.read_report import ReadReport

    if metres_per_unit(scene) != 1.0:
        yield f"the lesson: {UNIT}"
        return
    try:
        report, graph = ReadReport(), read_scene(scene, details=False)
        playable_lessons(graph, report, _Nodes(graph, scene, dict.fromkeys(range(len(graph)), 0)))
    except UniSGError as error:
        yield in_window(str(error))
        return
    yield from map(in_window, report)


class _Nodes:
    """The node of each row in the exported file; a lesson that asks for one that has none is not written."""

    def __init__(self, graph: SceneGraph, scene: bpy.types.Scene, nodes: Mapping[int, int]) -> None:
        from ...unisg_blender.blender.lookup import objects_by_uid

        self._graph, self._nodes, self._objects = graph, nodes, objects_by_uid(scene)

    def __call__(self, row: int) -> int:
        item = self._objects.get(self._graph.uid[row])
        if item is not None and item.type in TURNED:
            raise UniSGError(f"{item.name!r} is a {item.type.lower()}, which Blender's exporter turns")
        if row not in self._nodes:
            raise UniSGError(f"{self._graph.name[row]!r} is not in the file: export it too")
        return self._nodes[row]


class LessonExtension:
    """What Blender's exporter calls; one for each export."""

    def __init__(self) -> None:
        from ...unisg_blender.blender.scene_units import metres_per_unit

        self._scene = bpy.context.scene  # while it exports, Blender steps through all scenes
        self._wanted = getattr(bpy.context.window_manager, WANTED, False)
        self._in_metres = metres_per_unit(self._scene) == 1.0
        self._graph: SceneGraph | None = None
        self._rows: dict[str, int] = {}
        self._tree: Mapping[str, Any] = {}

    def gather_node_hook(self, node: Any, item: Any, settings: dict[str, Any]) -> None:
        """Give an object's node what is ours as extras, whether custom properties are exported or not."""
        from ...unisg_blender.scene.properties import NAMES, encode_properties

        asked = self._wanted and self._in_metres and isinstance(item, bpy.types.Object)
        row = self._row(item) if asked else None
        if row is not None and self._graph is not None:
            ours = {key: value for key, value in encode_properties(self._graph, row).items() if key in NAMES}
            node.extras = {**(node.extras or {}), **ours}

    def gather_scene_hook(self, scene: Any, of: bpy.types.Scene, settings: dict[str, Any]) -> None:
        """Keep what the exporter makes of the scene that a user is in: each scene has such a tree."""
        if of == self._scene:
            self._tree = settings["vtree"].nodes

    def gather_gltf_extensions_hook(self, document: Any, settings: dict[str, Any]) -> None:
        """Write the graph of the lesson, and tell what it cannot carry."""
        if not self._wanted or not looked_up(self._scene).lessons:
            return
        try:
            self._add(document, settings)
        except UniSGError as error:
            _tell(settings, f"No lesson in the file: {in_window(str(error))}")

    def _add(self, document: Any, settings: dict[str, Any]) -> None:
        from ...unisg_blender.formats.gltf.gltf_lessons import SELECTABLE, playable_lessons, selected_nodes
        from ...unisg_blender.runtime.read_report import ReadReport

        if not settings["gltf_yup"]:
            raise UniSGError(UP)
        if not self._in_metres:
            raise UniSGError(UNIT)
        graph, report = self._read(), ReadReport()
        nodes = _Nodes(graph, self._scene, self._numbers(document))
        lessons = playable_lessons(graph, report, nodes)
        document.extensions.update(lessons)
        document.extensions_used += lessons
        for number in selected_nodes(lessons):
            document.nodes[number].extensions = {**(document.nodes[number].extensions or {}), **SELECTABLE}
        document.extensions_used += SELECTABLE
        if len(report):
            _tell(settings, f"Of the lesson: {in_window(report.summary(most=3))}")

    def _numbers(self, document: Any) -> dict[int, int]:
        """The number of each row's node; of an object that is instanced too, that of the object itself."""
        place = {id(node): number for number, node in enumerate(document.nodes)}
        found: dict[int, int] = {}
        for each in sorted(self._tree.values(), key=lambda each: _instancers(self._tree, each), reverse=True):
            row = self._row(each.blender_object) if each.blender_bone is None else None
            if row is not None and id(each.node) in place:
                found[row] = place[id(each.node)]
        return found
        return found

    def _row(self, item: bpy.types.Object | None) -> int | None:
        self._read()
        return None if item is None else self._rows.get(item.name_full)

    def _read(self) -> SceneGraph:
        from ...unisg_blender.blender import read_scene
        from ...unisg_blender.blender.lookup import objects_by_uid

        if self._graph is None:
            self._graph = graph = read_scene(self._scene, details=False)
            objects = objects_by_uid(self._scene)
            self._rows = {objects[uid].name_full: row for row, uid in enumerate(graph.uid) if uid in objects}
        return self._graph


def _tell(settings: Mapping[str, Any], text: str) -> None:
    """Say something in the exporter's report; exporters that have none get it on the console."""
    log = settings.get("log")
    if log is None:
        print(text)
    else:
        log.warning(text, popup=True)


def _instancers(tree: Mapping[str, Any], node: Any) -> int:
    """How many collection instances a node of the exporter is in."""
    count = 0
    while node.parent_uuid is not None:
        node = tree[node.parent_uuid]
        count += node.blender_object is not None and node.blender_object.instance_type == "COLLECTION"
    return count


CLASSES = ()
PROPERTIES = (
    (
        bpy.types.WindowManager, WANTED,
        bpy.props.BoolProperty(
            name="UniSG lesson", default=True,
            description="Write the lesson as KHR_interactivity, and categories and actions as extras",
        ),
    ),
)  # fmt: skip


def unregister() -> None:
    """Forget what was told."""
    _told.clear()

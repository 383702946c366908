"""From a scenegraph to the specs of a USD layer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from pxr import Sdf, Vt

from ...scene import components
from ...scene.component_table import Table
from ...scene.frame_range import DEFAULT_RATE
from ...scene.graph import TYPE_INDEX, TYPES, SceneGraph
from ...scene.hierarchy import world_matrices
from ...scene.mesh import Mesh
from ...scene.motion_frames import frame_range_of
from .. import schema
from ..names import Identifiers, clean
from .behaviour_specs import write_behaviour
from .camera_light_specs import write_camera, write_light, write_visibility
from .component_specs import write_components
from .instance_specs import write_instances
from .mesh_specs import write_materials, write_mesh
from .physics_specs import write_labels, write_physics
from .specs import Types, attribute, custom, define, define_class, matrices
from .time_sample_specs import write_frame_range, write_motion

PLAIN = Vt.TokenArray([schema.TRANSFORM])
RESETTING = Vt.TokenArray([schema.RESET, schema.TRANSFORM])
FLAT = 1e9
"""Condition number from which on a matrix counts as not invertible."""

Tick = Callable[[], None]


@dataclass
class LayerWriter:
    """What stays the same while one layer is written."""

    scene: Any
    materials: dict[str, Any]
    shared: dict[int, Any]  # references to prototypes of meshes that several entities share, by id(mesh)
    tick: Tick
    rate: float  # time codes per second
    prototypes: dict[int, Any] = field(default_factory=dict)  # paths of instanced scenegraphs, by id(graph)

    def prototype_path(self, graph: SceneGraph) -> Any:
        """Path of the prototype of a scenegraph, written once."""
        if id(graph) not in self.prototypes:
            scope = self.scene.nameChildren.get(schema.PROTOTYPE_SCOPE)
            if scope is None:
                scope = define_class(self.scene, schema.PROTOTYPE_SCOPE)
            taken = Identifiers(child.name for child in scope.nameChildren)
            prim = define(scope, taken.take(graph.title), "Xform", graph.title)
            self.prototypes[id(graph)] = prim.path
            write_graph(prim, graph, self, Identifiers(schema.SCOPES))
        return self.prototypes[id(graph)]


def write_layer(graph: SceneGraph, layer: Any, tick: Tick = lambda: None) -> None:
    """Author the scenegraph in an empty layer; ``tick`` is called once per entity."""
    layer.pseudoRoot.SetInfo("upAxis", "Z")
    layer.pseudoRoot.SetInfo("metersPerUnit", 1.0)
    if components.RIGID_BODIES in graph.components:
        layer.pseudoRoot.SetInfo("kilogramsPerUnit", 1.0)
    frames = frame_range_of(graph)
    with Sdf.ChangeBlock():
        identifier = Identifiers().take(graph.title)
        layer.defaultPrim = identifier
        scene = define(layer, identifier, "Xform", graph.title)
        scene.SetInfo("kind", "assembly")
        custom(scene, schema.SCENE_VERSION, Types.Int, schema.VERSION)
        if frames is not None:
            write_frame_range(frames, scene)
        materials = write_materials(scene, _all_materials(graph))
        shared = _write_shared_meshes(scene, graph, materials)
        writer = LayerWriter(scene, materials, shared, tick, frames.rate if frames else DEFAULT_RATE)
        write_graph(scene, graph, writer, Identifiers(schema.SCOPES))


def write_graph(parent: Any, graph: SceneGraph, writer: LayerWriter, identifiers: Identifiers) -> None:
    """Author all entities of a scenegraph under ``parent``, and its component tables in a scope beside them."""
    prims = _write_entities(parent, graph, writer, identifiers)
    write_behaviour(prims, graph)
    write_motion(prims, graph, writer.rate)
    write_visibility(prims, graph)
    write_physics(prims, graph)
    write_components(parent, graph)
    write_instances(prims, graph, writer.prototype_path)


def nested_graphs(graph: SceneGraph) -> list[SceneGraph]:
    """The scenegraph and all that it instances, each once."""
    found = {id(graph): graph}
    stack = [graph]
    while stack:
        for _, prototype in stack.pop().entries(components.INSTANCES, "prototype"):
            if id(prototype) not in found:
                found[id(prototype)] = prototype
                stack.append(prototype)
    return list(found.values())


def _all_materials(graph: SceneGraph) -> dict[str, Any]:
    return {name: material for part in nested_graphs(graph)[::-1] for name, material in part.materials.items()}


def _write_shared_meshes(scene: Any, graph: SceneGraph, materials: dict[str, Any]) -> dict[int, Any]:
    """Prototypes of the meshes that more than one entity has; references to them by id(mesh)."""
    uses: dict[int, int] = {}
    meshes: dict[int, Mesh] = {}
    for part in nested_graphs(graph):
        counts = np.bincount(part.mesh[part.mesh >= 0], minlength=len(part.meshes))
        for mesh, count in zip(part.meshes, counts, strict=True):
            uses[id(mesh)] = uses.get(id(mesh), 0) + int(count)
            meshes[id(mesh)] = mesh
    shared = [key for key, count in uses.items() if count > 1]
    if not shared:
        return {}
    scope = define_class(scene, schema.MESH_SCOPE)
    identifiers = Identifiers()
    references = {}
    for key in shared:
        prim = define(scope, identifiers.take(meshes[key].name), "Mesh")
        prim.SetInfo("displayName", clean(meshes[key].name))  # also where it is its identifier: users differ in theirs
        write_mesh(prim, meshes[key], materials)
        references[key] = Sdf.ReferenceListOp.Create(prependedItems=[Sdf.Reference("", prim.path)])
    return references


def _write_entities(parent: Any, graph: SceneGraph, writer: LayerWriter, top: Identifiers) -> list[Any]:
    moved = _moved(graph)
    cameras, lights = (graph.components.get(name) for name in (components.CAMERA, components.LIGHT))
    local, counts = matrices(graph.local), graph.info.tolist()
    hidden_names: dict[int, Identifiers] = {-1: top}
    prims: list[Any] = []
    for row, (name, above) in enumerate(zip(graph.name, graph.parent.tolist(), strict=True)):
        siblings = hidden_names.get(above)
        if siblings is None:
            siblings = hidden_names[above] = Identifiers()
        prim = define(prims[above] if above >= 0 else parent, siblings.take(name), "Xform", name)
        prims.append(prim)
        if above < 0 and parent == writer.scene:
            prim.SetInfo("kind", "component")
        _write_transform(prim, local[row], moved.get(row))
        custom(prim, schema.UID, Types.String, clean(graph.uid[row]))
        if graph.category[row] >= 0:
            custom(prim, schema.CATEGORY, Types.String, clean(graph.vocabulary[graph.category[row]]))
            write_labels(prim, graph.vocabulary[graph.category[row]])
        if counts[row] != [0, 1, int(graph.mesh[row] >= 0), 0]:
            custom(prim, schema.INFO, Types.Int4, tuple(counts[row]))
        _write_shape(prim, graph, row, hidden_names, writer, (cameras, lights))
        writer.tick()
    return prims


@dataclass(frozen=True)
class Moved:
    """An entity that stands elsewhere than ``local`` says: its world matrix, and what leads there from its parent."""

    world: Any
    relative: Any
    resets: bool


def _moved(graph: SceneGraph) -> dict[int, Moved]:
    """Entities with the component ``world``; those whose parent is flat must ignore the parent's transform."""
    found = graph.components.get(components.WORLD)
    if found is None:
        return {}
    rows = found.rows
    evaluated = np.concatenate([world_matrices(graph), np.eye(4)[None]])
    above = evaluated[graph.parent[rows]]
    flat = ~(np.linalg.cond(above[:, :3, :3]) < FLAT)
    above[flat] = np.eye(4)
    relative = np.linalg.solve(above, evaluated[rows])
    parts = zip(matrices(evaluated[rows]), matrices(relative), flat.tolist(), strict=True)
    return {row: Moved(*part) for row, part in zip(rows.tolist(), parts, strict=True)}


def _write_transform(prim: Any, local: Any, moved: Moved | None) -> None:
    if moved is not None:
        custom(prim, schema.LOCAL, Types.Matrix4d, local, uniform=False)
        custom(prim, schema.WORLD, Types.Matrix4d, moved.world)
    value = local if moved is None else moved.relative
    attribute(prim, schema.TRANSFORM, Types.Matrix4d, value, uniform=False)
    order = RESETTING if moved is not None and moved.resets else PLAIN
    attribute(prim, "xformOpOrder", Types.TokenArray, order)


def _write_shape(
    prim: Any, graph: SceneGraph, row: int, names: dict[int, Identifiers], writer: LayerWriter,
    tables: tuple[Table | None, Table | None],
) -> None:  # fmt: skip
    """What the entity looks like: a Mesh, Camera or light under its Xform; its type where that does not tell it."""
    kind, shown = TYPES[graph.type[row]], "EMPTY"
    children = names.setdefault(row, Identifiers())
    if graph.mesh[row] >= 0:
        mesh, shown = graph.meshes[graph.mesh[row]], "MESH"
        shape = define(prim, children.take(prim.name), "Mesh")
        reference = writer.shared.get(id(mesh))
        if reference is None:
            if mesh.name != shape.name:
                shape.SetInfo("displayName", clean(mesh.name))
            write_mesh(shape, mesh, writer.materials)
        else:
            shape.SetInfo("references", reference)
    elif graph.type[row] == TYPE_INDEX["CAMERA"]:
        shown = write_camera(prim, children, tables[0], row)
    elif graph.type[row] == TYPE_INDEX["LIGHT"]:
        shown = write_light(prim, children, tables[1], row)
    if shown != kind:
        custom(prim, schema.TYPE, Types.Token, kind)

"""From a USD stage to a scenegraph."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pxr import Tf, Usd

from ...errors import UniSGError
from ...scene import components
from ...scene.assembly import Columns, assemble
from ...scene.graph import SceneGraph
from ...scene.identity import resolve_uids
from .. import schema
from ..entity_progress import Progress, ticks
from ..names import true_name
from .camera_light_prims import read_data
from .component_scopes import read_components
from .elements import is_elements, read_elements
from .entity_attributes import read_entries
from .entity_selection import find_entities
from .instancers import read_instances
from .layer_files import quiet
from .mesh_prims import MeshPrims
from .physics_prims import read_bodies
from .stage import first_reason, stage_frame
from .stage_frames import with_frame_range
from .time_samples import read_motion
from .unsupported_prims import tell_losses
from .xforms import read_transforms

STANDARD = (components.CAMERA, components.LIGHT, components.VISIBILITY)
"""Components of which USD's own schemas say a part."""
WITHIN = Usd.TraverseInstanceProxies(Usd.PrimIsActive & Usd.PrimIsDefined)


@dataclass
class StageReader:
    """What stays the same while one stage is read."""

    frame: NDArray[np.float64]  # the stage's frame to metres and Z up
    metres: float  # size of a scene unit
    rate: float  # time codes per second
    shelf: MeshPrims
    progress: Progress | None
    kilograms: float = 1.0  # a unit of mass
    prototypes: dict[Any, SceneGraph] = field(default_factory=dict)
    reading: set[Any] = field(default_factory=set)  # prototypes that are being read

    def read_prototype(self, prim: Any, children: bool) -> SceneGraph:
        """The scenegraph of a prototype prim, the same object for the same prototype.

        ``children``: the prim only holds the prototype's entities, as ours do.
        """
        stack = prim.GetPrimStack()
        key = (stack[-1].layer.identifier, stack[-1].path) if children else prim.GetPath()
        if key in self.reading:
            raise UniSGError(f"{prim.GetPath()}: is a prototype of itself")
        if key not in self.prototypes:
            self.reading.add(key)
            name = true_name(prim, stack[-1].name if children else "")
            tops = prim.GetFilteredChildren(WITHIN) if children else [prim]
            self.prototypes[key] = read_graph(tops, self, name, prim if children else None, nested=True)
            self.reading.discard(key)
        return self.prototypes[key]


def read_stage(stage: Any, title: str, progress: Progress | None = None) -> SceneGraph:
    """The scenegraph of a composed stage; ``title`` for stages that have none.

    Raises
    ------
    UniSGError
        If the stage was written by a newer version.
    """
    try:
        with quiet() as messages:
            graph = read_elements(stage, title) if is_elements(stage) else _read_scene(stage, title, progress)
    except Tf.ErrorException as error:  # values are unpacked when they are asked for
        raise UniSGError(f"{title}: not a readable USD file: {first_reason(error)}") from None
    except RecursionError:
        raise UniSGError(f"{title}: its instances nest too deeply to be read") from None
    for text in dict.fromkeys(messages):
        warnings.warn(f"{title}: {text}", stacklevel=3)
    return graph


def _read_scene(stage: Any, title: str, progress: Progress | None) -> SceneGraph:
    frame = stage_frame(stage)
    metres = float(np.abs(frame[:3, :3]).max())
    reader = StageReader(frame, metres, float(stage.GetTimeCodesPerSecond()), MeshPrims(frame), progress)
    reader.kilograms = float(stage.GetMetadata("kilogramsPerUnit") or 1.0)
    tops = stage.GetPseudoRoot().GetChildren()
    scene = next((prim for prim in tops if prim.HasAttribute(schema.SCENE_VERSION)), None)
    if scene is None:
        return with_frame_range(read_graph(tops, reader, title), stage, reader.rate)
    version = scene.GetAttribute(schema.SCENE_VERSION).Get()
    if not isinstance(version, int) or version > schema.VERSION:
        raise UniSGError(f"{title}: has version {version}; this software reads up to {schema.VERSION}: update it")
    reader.shelf.keep_materials(scene.GetChild(schema.MATERIAL_SCOPE))
    tops = [*scene.GetChildren(), *(prim for prim in tops if prim != scene)]
    graph = read_graph(tops, reader, true_name(scene), scene)
    return with_frame_range(graph, stage, reader.rate, scene.GetAttribute(schema.FRAME).Get())


def read_graph(
    tops: list[Any], reader: StageReader, title: str, holder: Any = None, *, nested: bool = False
) -> SceneGraph:
    """The scenegraph of some prims and all below them.

    ``holder`` is the prim that has their component tables; ``nested`` reads what a
    stage does not show by itself, as prototypes.
    """
    found = find_entities(tops, nested)
    tell_losses(found)
    entries = read_entries(found, ticks(len(found.prim), None if nested else reader.progress))
    uids = resolve_uids([entry.stored.uid for entry in entries], [entry.name for entry in entries])
    frames = read_transforms(found, reader.frame)
    shelf_mesh = reader.shelf.column(found.shape, found.kind)
    used, mesh = np.unique(shelf_mesh[shelf_mesh >= 0], return_inverse=True)
    column = np.full(len(entries), -1, np.int32)
    column[shelf_mesh >= 0] = mesh.reshape(-1)
    tables = read_components(holder, uids) | frames.tables | read_motion(found, frames, reader.rate)
    tables |= read_instances(found, reader.frame, reader.read_prototype)
    tables |= read_bodies(found, tables, reader.kilograms)
    told = read_data(found, tables, reader.metres)
    tables = {name: each for name, each in tables.items() if name not in STANDARD} | told
    uid_of_path = {prim.GetPath(): uid for prim, uid in zip(found.prim, uids, strict=True)}
    return assemble(
        Columns(
            name=[entry.name for entry in entries],
            type=[entry.type or kind for entry, kind in zip(entries, found.kind, strict=True)],
            parent=np.array(found.parent, np.int32),
            local=frames.local,
            mesh=column,
            meshes=[reader.shelf.meshes[index] for index in used],
            properties=[entry.with_relations(uid_of_path) for entry in entries],
            materials={} if nested else reader.shelf.materials,
            components=tables,
            title=title,
        )
    )

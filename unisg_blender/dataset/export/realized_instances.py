"""Instances as objects of a dataset: what collections, geometry nodes and particles show more than once."""

from __future__ import annotations

import numpy as np

from ...scene import SceneGraph, Table
from ...scene.components import INSTANCES
from ...scene.realize_instances import count_copies, realize

MOST_COPIES = 10_000
"""Entities that instances may become in one scene; grass and gravel are no objects."""


def realize_objects(graph: SceneGraph) -> tuple[SceneGraph, str]:
    """The scene with its instances as entities, and what is left out of it in words.

    What geometry nodes and particles show has the category of the object that they
    show. Where the copies would be more than :data:`MOST_COPIES` all of them are left out.
    """
    instances = graph.components.get(INSTANCES)
    if instances is None or not len(instances.rows):
        return graph, ""
    copies = count_copies(graph)
    if copies > MOST_COPIES:
        return graph, f"{copies} copies in instances (more than {MOST_COPIES} are left out)"
    return realize(graph.with_component(INSTANCES, _categorised(graph, instances))), ""


def _categorised(graph: SceneGraph, instances: Table) -> Table:
    """The instances; those of single drawn objects with the categories that these objects have in the scene."""
    known = {name: graph.category_name(row) for row, name in enumerate(graph.name) if graph.category[row] >= 0}
    made: dict[tuple[int, str], SceneGraph] = {}
    column = instances.columns["prototype"].copy()
    for place, (row, source) in enumerate(zip(instances.rows.tolist(), instances.columns["source"], strict=True)):
        prototype = column[place]
        if source != "GEOMETRY" or prototype.category[0] >= 0 or prototype.name[0] == graph.name[row]:
            continue
        if category := known.get(prototype.name[0], ""):
            if (id(prototype), category) not in made:
                made[id(prototype), category] = prototype.replace(
                    category=np.zeros(1, np.int32), vocabulary=(category,)
                )
            column[place] = made[id(prototype), category]
    return Table(instances.rows, {**instances.columns, "prototype": column})

"""What instances show, as entities while things are placed: a lamp that is a collection instance is in the way."""

from __future__ import annotations

import numpy as np

from ...dataset.export.realized_instances import realize_objects
from ...scene import SceneGraph, table
from ...scene.component_table import Table
from ...scene.components import INSTANCES, RELATIONS
from ...scene.hierarchy import take


def with_instances(graph: SceneGraph) -> SceneGraph:
    """The scene with its instances as entities; as it is where there are none, or too many to be things."""
    return realize_objects(graph)[0]


def without_instances(result: SceneGraph, before: SceneGraph, shown: SceneGraph) -> SceneGraph:
    """A scene that grew out of ``shown``, :func:`with_instances` of ``before``, with instances for entities again.

    What was put onto such an entity stands there by itself, and its relation names the entity that has the instance.
    """
    if shown is before:
        return result
    owner = _owners(before, shown)
    kept = take(result, np.array([row for row, uid in enumerate(result.uid) if uid not in owner], np.int64))
    instances = before.components[INSTANCES]
    rows = [kept.row_of_uid[before.uid[row]] for row in instances.rows.tolist()]
    order = np.argsort(rows, kind="stable")
    columns = {name: column[order] for name, column in instances.columns.items()}
    kept = kept.with_component(INSTANCES, Table(np.array(rows, np.int32)[order], columns))
    said = kept.components.get(RELATIONS)
    if said is None:
        return kept
    targets = [owner.get(uid, uid) for uid in said.columns["target"]]
    return kept.with_component(RELATIONS, table(said.rows, kind=said.columns["kind"], target=targets))


def _owners(before: SceneGraph, shown: SceneGraph) -> dict[str, str]:
    """By uid of an entity that an instance shows the uid of the entity that has the instance."""
    known = set(before.uid)
    found: dict[str, str] = {}
    for row, uid in enumerate(shown.uid):
        if uid not in known:
            above = shown.uid[int(shown.parent[row])]
            found[uid] = found.get(above, above)
    return found

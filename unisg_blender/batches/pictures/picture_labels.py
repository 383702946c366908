"""What a picture shows: each object with its pixels, boxes and share visible, and the scenegraph of what is seen."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...dataset.told_categories import told_categories
from ...geometry.arrays import Bools, Floats, Ints
from ...geometry.camera_view import CameraView
from ...scene import SceneGraph, entry_table
from ...scene.assembly import index_categories
from ...scene.components import ACTIONS, LSA, RELATIONS
from ...scene.hierarchy import take
from ...spatial import relate
from ...spatial.object_rows import Objects, find_objects
from ...spatial.structure.scan import world_triangles
from .silhouette import silhouette

COPY = re.compile(r"(?<=\S)[._ -]?\d+$")
"""The number that a copy's name ends with: Apple.001 is an Apple."""


def labelled(graph: SceneGraph) -> SceneGraph:
    """The scene in which every object with a mesh has a category: its own, what its name or its place says, or its name
    without the number of a copy."""
    told = told_categories(graph)
    objects = find_objects(told, empty=False)
    names = [told.category_name(row) for row in range(len(told))]
    for row in objects.rows.tolist():
        names[row] = names[row] or COPY.sub("", told.name[row].strip()) or told.name[row] or "Object"
    category, vocabulary = index_categories(names)
    return told.replace(category=category, vocabulary=vocabulary)


@dataclass(frozen=True, eq=False)
class LabelledScene:
    """A scene whose pictures are labelled: its objects, whose each row is, and the triangles of what is shown."""

    graph: SceneGraph
    objects: Objects
    owner: Ints
    triangles: dict[int, Floats]

    @staticmethod
    def of(graph: SceneGraph, shown: Bools) -> LabelledScene:
        """That of a :func:`labelled` scene, of which some rows (N,) are shown."""
        objects = find_objects(graph, empty=False)
        owner = np.where(objects.of_row >= 0, objects.rows[objects.of_row], np.arange(len(graph)))
        triangles, row = world_triangles(graph)
        kept = shown[row]
        triangles, of_row = triangles[kept], owner[row[kept]]
        order = np.argsort(of_row, kind="stable")
        rows, starts = np.unique(of_row[order], return_index=True)
        parts = np.split(triangles[order], starts[1:])
        return LabelledScene(graph, objects, owner, dict(zip(rows.tolist(), parts, strict=True)))

    def instances(self, row: NDArray[np.int32]) -> NDArray[np.int32]:
        """Whose object each pixel is by the rows that it shows (height, width): the object's row and 1, 0 for none."""
        return (np.append(self.owner, -1)[row] + 1).astype(np.int32)

    def labels(self, view: CameraView, instances: NDArray[np.int32]) -> list[dict[str, Any]]:
        """Every object that a picture shows, JSON-ready, by ascending number."""
        numbers, counts = np.unique(instances[instances > 0], return_counts=True)
        found = []
        for number, pixels in zip(numbers.tolist(), counts.tolist(), strict=True):
            row = number - 1
            lines, columns = np.nonzero(instances == number)
            x, y = int(columns.min()), int(lines.min())
            alone = silhouette(view, self.triangles[row])
            found.append({
                "id": number, "uid": self.graph.uid[row], "name": self.graph.name[row],
                "category": self.graph.category_name(row), "pixels": pixels,
                "bbox": [x, y, int(columns.max()) - x + 1, int(lines.max()) - y + 1],
                "whole_bbox": None if alone is None else [round(value, 2) for value in alone.box],
                "share_visible": None if alone is None else round(min(1.0, pixels / max(alone.area, pixels)), 4),
                "truncated": alone is None or alone.truncated,
                "box": self._box(row),
            })  # fmt: skip
        return found

    def _box(self, row: int) -> dict[str, Any]:
        """The tightest box along an object's own axes, metres in the world; the axes are columns."""
        (number,) = np.flatnonzero(self.objects.rows == row)
        box = self.objects.oriented
        return {
            "center": box.center[number].round(6).tolist(),
            "axes": box.axes[number].round(6).tolist(),
            "half": box.half[number].round(6).tolist(),
        }

    def seen_graph(self, instances: NDArray[np.int32]) -> SceneGraph:
        """The scenegraph of the objects that a picture shows, with the relations among them.

        Actions stay whose targets, tools and frame are all seen; the lesson, which is of the whole scene, does not.
        """
        wanted = np.isin(self.owner, np.unique(instances[instances > 0]) - 1)
        graph = take(self.graph, np.flatnonzero(wanted))
        uids = set(graph.uid)
        said = [entry for entry in graph.entries(RELATIONS, "kind", "target") if entry[2] in uids]
        actions = [
            (row, action) for row, action in graph.entries(ACTIONS, "data")
            if not action.members and {*action.targets, *action.tools, *filter(None, [action.frame])} <= uids
        ]  # fmt: skip
        kept = {name: table for name, table in graph.components.items() if name != LSA}
        graph = graph.replace(components=kept)
        graph = graph.with_component(RELATIONS, entry_table(said, "kind", "target"))
        return relate(graph.with_component(ACTIONS, entry_table(actions, "data")))

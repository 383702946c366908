"""A scene as a model's vocabulary has it: what each of its things is called, and as what that was understood."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..geometry.arrays import Floats
from ..scene import SceneGraph
from ..scene.assembly import index_categories
from ..scene.categories import STRUCTURE
from ..scene.components import INSTANCES
from ..scene.graph import TYPE_INDEX
from .split_names import name_words, singular_forms, telling_words
from .vocabulary_match import BROAD, KIND, MAPPED, SAME, WORD, VocabularyMatch, WordMatch

BY_GEOMETRY = frozenset(("Floor", "Wall", "Ceiling", "Column", "Stairs"))
"""What is not taken from names: where it is tells more than how it is called."""

GROUPS = frozenset(("set", "group", "collection", "furniture", "objects"))
"""Words in the names of entities that only hold several things together."""

PRIMITIVES = (["box"], ["plate"], ["tube"], ["column"], ["cup"])
"""Names of meshes that speak of their shape, not of what it stands for."""

SOLID = (TYPE_INDEX["MESH"], TYPE_INDEX["EMPTY"])


@dataclass(frozen=True)
class Understood:
    """A row of a scene whose category or name (``said``, from ``source``) was understood, and as what."""

    row: int
    said: str
    source: str
    match: WordMatch


@dataclass(frozen=True, eq=False)
class SceneWords:
    """The scene with its categories in a vocabulary, as far as they were understood, and what was understood."""

    graph: SceneGraph
    understood: tuple[Understood, ...]

    def lines(self) -> list[str]:
        """What was understood, a line for each thing and category, those first that the user should look at."""
        found: dict[WordMatch, list[str]] = {}
        for item in self.understood:
            if item.match.how not in (SAME, ""):
                found.setdefault(item.match, []).append(item.said)
        order = sorted(found.items(), key=lambda entry: (entry[0].how not in (BROAD, KIND), entry[1][0]))
        return [_line(match, said) for match, said in order if not _is_plain(match, said)]


def _is_plain(match: WordMatch, said: Sequence[str]) -> bool:
    """Whether all of it is called as the category is, but for numbers and endings."""
    form = "".join(name_words(match.category))
    return match.how == WORD and all(form in singular_forms("".join(telling_words(word))) for word in said)


def _line(match: WordMatch, said: Sequence[str]) -> str:
    many = f" ({len(said)} objects)" if len(said) > 1 else ""
    if match.how == MAPPED:
        return f"{said[0]} -> {match.category or 'nothing'}, as the mapping says{many}"
    if match.how == KIND:
        return f"{said[0]} -> {match.category}, which is broader{many}"
    if match.how == BROAD:
        rest = f"; it may be {' or '.join(match.others)}" if match.others else ", which is one kind of it"
        return f"{said[0]} -> {match.category}{rest}{many}"
    return f"{said[0]} -> {match.category}{many}"


def understand(
    graph: SceneGraph, vocabulary: Sequence[str], said: Mapping[str, str] | None = None,
    sizes: Mapping[str, Sequence[float]] | None = None, *, keep: Collection[str] = STRUCTURE,
) -> SceneWords:  # fmt: skip
    """Read a scene in the vocabulary of a model.

    A category that the vocabulary lacks is translated; a thing without one has that of its name, or of its mesh's
    name. Nothing is taken from the names of parts (:data:`~.word_table.PARTS`), nor what is building
    (:data:`BY_GEOMETRY`). What is not understood keeps its category, or has none.

    Parameters
    ----------
    said, sizes
        See :class:`~.vocabulary_match.VocabularyMatch`.
    keep
        Categories beyond the vocabulary that are understood as they are.
    """
    known = list(dict.fromkeys([*vocabulary, *keep]))
    words = VocabularyMatch(known, said, sizes)
    extents = _extents(graph)
    names: list[str] = []
    above: list[str] = []
    found: list[Understood] = []
    for row in range(len(graph)):  # parents come first
        own = graph.category_name(row)
        size = extents[row] if np.isfinite(extents[row]).all() else None
        match, told, source = (words.match(own, size), own, "category") if own else _of_name(graph, row, words, size)
        holder = above[graph.parent[row]] if graph.parent[row] >= 0 else ""
        if not own and not _is_thing(graph, row, match, holder):
            match = WordMatch()
        names.append(match.category or own)
        above.append(names[-1] or holder)
        if match.category or match.thing:
            found.append(Understood(row, told, source, match))
    if all(name == graph.category_name(row) for row, name in enumerate(names)):
        return SceneWords(graph, tuple(found))
    category, names_used = index_categories(names)
    return SceneWords(graph.replace(category=category, vocabulary=names_used), tuple(found))


def _of_name(graph: SceneGraph, row: int, words: VocabularyMatch, size: Floats | None) -> tuple[WordMatch, str, str]:
    """What an entity's name says, or else that of its mesh."""
    mesh = graph.meshes[graph.mesh[row]].name if graph.mesh[row] >= 0 else ""
    for name in (graph.name[row], "" if is_shape_name(mesh) else mesh):
        match = words.match(name, size)
        if match.category or match.thing:
            return match, name, "name"
    return WordMatch(), "", "name"


def is_shape_name(name: str) -> bool:
    """Whether the name of a mesh speaks of its shape only, as modelling software gives it: "Box01", "Tube"."""
    return name_words(name) in PRIMITIVES


def _is_thing(graph: SceneGraph, row: int, match: WordMatch, holder: str) -> bool:
    """Whether a row without a category is a thing of its own, as its name says: no part, no group, nothing built.

    What is called as the nearest thing above, its ``holder``, is what that is made of.
    """
    if match.part or match.category in BY_GEOMETRY or graph.type[row] not in SOLID:
        return False
    if match.category and match.category == holder:
        return False
    if graph.mesh[row] < 0 and match.category:
        return _stands_for_one(graph, row)
    return True


def _stands_for_one(graph: SceneGraph, row: int) -> bool:
    """Whether an entity without a mesh is one thing made of parts, and not a group of several."""
    written = name_words(graph.name[row])
    if not GROUPS.isdisjoint(written):
        return False
    instances = graph.components.get(INSTANCES)
    if instances is not None and row in instances.rows:
        return True
    children = np.flatnonzero(graph.parent == row)
    plural = bool(written) and len(singular_forms(written[-1])) > 1
    return len(children) == 1 or (len(children) > 0 and not plural)


def _extents(graph: SceneGraph) -> Floats:
    """Extents (N, 3) along the world's axes of what hangs under each row, metres; NaN without geometry."""
    low, high = np.full((len(graph), 3), np.inf), np.full((len(graph), 3), -np.inf)
    for row in np.flatnonzero(graph.mesh >= 0).tolist():
        points = graph.meshes[graph.mesh[row]].points
        if not len(points):
            continue
        corners = points.min(axis=0), points.max(axis=0)
        box = np.array(np.meshgrid(*np.transpose(corners))).reshape(3, -1).T
        placed = box @ graph.world[row, :3, :3].T + graph.world[row, :3, 3]
        low[row], high[row] = placed.min(axis=0), placed.max(axis=0)
    for row in range(len(graph) - 1, -1, -1):
        parent = graph.parent[row]
        if parent >= 0:
            low[parent], high[parent] = np.minimum(low[parent], low[row]), np.maximum(high[parent], high[row])
    with np.errstate(invalid="ignore"):
        return np.where(high >= low, high - low, np.nan)

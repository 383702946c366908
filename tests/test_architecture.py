"""The plan of the house holds: arrows point down, heavy imports stay in their rooms, files and functions stay small.

The rooms and the arrows between them stand in ``packaging/architecture.py``; docs/architecture.md explains them.
"""

from __future__ import annotations

import ast
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable

import numpy as np
import pytest
from architecture import ARROWS, GROUND, LAYERS, LIBRARY, allowed, imported_names, imports, modules, room_arrows
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

BLENDER = {"bpy", "bmesh", "mathutils", "gpu", "gpu_extras", "blf"}
TORCH = {"torch", "torch_geometric", "pytorch_lightning"}
FILE_LINES = 300
FUNCTION_LINES = 60
FILES_SIDE_BY_SIDE = 25
SHARED_FILE_NAMES = 15


def in_circles(arrows: Iterable[tuple[str, str]]) -> set[str]:
    """Names from which arrows lead around and back."""
    pairs = [(a, b) for a, b in arrows if a != b]
    names = sorted({name for pair in pairs for name in pair})
    number = {name: row for row, name in enumerate(names)}
    ends = np.array([[number[a], number[b]] for a, b in pairs], dtype=int).reshape(-1, 2).T
    graph = coo_array((np.ones(ends.shape[1]), (ends[0], ends[1])), shape=(len(names), len(names)))
    part = connected_components(graph, directed=True, connection="strong")[1]
    return {name for name, label in zip(names, part, strict=True) if (part == label).sum() > 1}


def upward_or_unknown_arrows() -> set[str]:
    """Imports that the table of arrows does not allow."""
    return {
        f"{source.path.as_posix()} -> {target.name}"
        for source, target in imports()
        if source.room not in (target.room, LIBRARY) and target.room not in (LIBRARY, *allowed(source.room))
    }


def arrows_that_nothing_needs() -> set[str]:
    """Arrows that the table allows and no import uses."""
    return {f"{a} -> {b}" for a, targets in ARROWS.items() for b in targets} - {f"{a} -> {b}" for a, b in room_arrows()}


def circles_of_files() -> set[str]:
    """Files that import each other, around however many corners."""
    return in_circles((source.name, target.name) for source, target in imports())


def circles_within_rooms() -> set[str]:
    """Folders and files standing side by side in one room that import each other."""
    return in_circles((a.subroom, b.subroom) for a, b in imports() if a.room == b.room)


def misplaced(names: set[str], rooms: set[str], deferred_too: bool) -> set[str]:
    """Imports of the outside packages ``names`` by files that stand in none of ``rooms``."""
    return {
        f"{module.path.as_posix()}: {name.split('.')[0]}"
        for module in modules().values()
        if not {module.room, module.subroom} & rooms
        for name, deferred in imported_names(module)
        if name.split(".")[0] in names and (deferred_too or not deferred)
    }


def blender_outside_its_rooms() -> set[str]:
    """Blender's modules, even inside functions, are for ``blender`` and the extension."""
    return misplaced(BLENDER, {"blender", "operators", "panels"}, deferred_too=True)


def torch_outside_learning() -> set[str]:
    """Torch is imported inside functions, but in ``learn`` and in two places that are opened for tensors only."""
    return misplaced(TORCH, {"learn", "dataset.graphs", "poses.polar_tensors"}, deferred_too=False)


def usd_outside_its_room() -> set[str]:
    """``pxr`` is for ``usd``."""
    return misplaced({"pxr"}, {"usd"}, deferred_too=True)


def long_files() -> set[str]:
    """Files of more lines than a reader takes in."""
    return {m.path.as_posix() for m in modules().values() if m.source.count("\n") > FILE_LINES}


def long_functions() -> set[str]:
    """Functions of more lines than a reader takes in, decorators not counted."""
    return {
        f"{module.path.as_posix()}: {node.name}"
        for module in modules().values()
        for node in ast.walk(module.tree)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        and (node.end_lineno or node.lineno) - node.lineno >= FUNCTION_LINES
    }


def crowded_folders() -> set[str]:
    """Folders with more files side by side than one looks through."""
    count = Counter(m.path.parent.as_posix() for m in modules().values() if not m.is_package)
    return {folder for folder, files in count.items() if files > FILES_SIDE_BY_SIDE}


def in_two_rooms(named: Iterable[tuple[str, str]]) -> set[str]:
    """Names, out of pairs (name, room), that stand in more than one room."""
    rooms = defaultdict(set)
    for name, room in named:
        rooms[name].add(room)
    return {f"{name}: {', '.join(sorted(where))}" for name, where in rooms.items() if len(where) > 1}


def file_names_in_two_rooms() -> set[str]:
    """File names that stand in two rooms, once they are more than a few."""
    shared = in_two_rooms((m.path.name, m.room) for m in modules().values() if not m.is_package)
    return shared if len(shared) > SHARED_FILE_NAMES else set()


def class_names_in_two_rooms() -> set[str]:
    """A class name means one thing in the whole house."""
    return in_two_rooms(
        (node.name, module.path.as_posix())
        for module in modules().values()
        for node in ast.walk(module.tree)
        if isinstance(node, ast.ClassDef)
    )


RULES: list[Callable[[], set[str]]] = [
    upward_or_unknown_arrows,
    arrows_that_nothing_needs,
    circles_of_files,
    circles_within_rooms,
    blender_outside_its_rooms,
    torch_outside_learning,
    usd_outside_its_room,
    long_files,
    long_functions,
    crowded_folders,
    file_names_in_two_rooms,
    class_names_in_two_rooms,
]


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.__name__)
def test_rule_holds(rule: Callable[[], set[str]]) -> None:
    violations = rule()
    assert not violations, "\n".join([rule.__doc__ or "", *sorted(violations)])


def test_arrows_point_down() -> None:
    level = {room: number for number, rooms in enumerate(LAYERS.values()) for room in rooms}
    assert set(level) == {*ARROWS, *GROUND}
    assert [f"{a} -> {b}" for a, targets in ARROWS.items() for b in targets if level[b] <= level[a]] == []


def test_every_room_stands_in_the_plan() -> None:
    assert {m.room for m in modules().values()} == {*ARROWS, *GROUND, LIBRARY}


def test_circles_are_found() -> None:
    assert in_circles([("a", "b"), ("b", "c"), ("c", "a"), ("c", "d"), ("d", "d")]) == {"a", "b", "c"}


def test_imports_are_read_at_every_depth() -> None:
    """Relative ones out of the extension, and those inside functions."""
    command_line = modules()["operators.command_line"]
    assert dict(imported_names(command_line))[f"{LIBRARY}.cli.main"]
    assert (command_line, modules()[f"{LIBRARY}.cli"]) in imports()

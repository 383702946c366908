"""The small lesson of a living room: an evening at home."""

from __future__ import annotations

from ..scene.action_data import ActionData
from ..scene.lesson_node import LessonNode
from .behaviour_script import Script, Thing, choices, turned
from .layout import Layout


def home_lesson(layout: Layout) -> tuple[dict[str, list[ActionData]], LessonNode | None]:
    """Actions by owner, and the operation: sit down, watch, tidy up; None where the room has nothing to do it with."""
    script, rng = Script(layout), layout.rng
    table, screen, remote = _first(layout, "Coffee Table"), _first(layout, "Television"), _first(layout, "Remote")
    stages = [
        _watch(script, screen, remote),
        _read(script, table),
        _tidy(script, table, remote, _first(layout, "Television Stand")),
    ]
    stages = [stage for stage in stages if stage.children]
    if not stages:
        return {}, None
    if rng.random() < 0.5:
        stages[:2] = stages[1::-1]
    return script.actions, script.operation("An evening at home", [script.lesson("Evening", stages)])


def _first(layout: Layout, category: str) -> Thing:
    found = layout.named(category)
    return found[int(layout.rng.integers(len(found)))] if found else None


def _watch(script: Script, screen: Thing, remote: Thing) -> LessonNode:
    rng = script.layout.rng
    on = script.use("Switch the television on", remote, screen, 0.5, distance=5.0, trigger=True)
    pillows, right = choices(rng, len(script.layout.named("Cushion")))
    count = script.ask("How many cushions are there?", _first(script.layout, "Sofa"), pillows, right)
    return script.stage("Watch", [on, count], ordered=bool(rng.random() < 0.5), optional=[count])


def _read(script: Script, table: Thing) -> LessonNode:
    """A book from the shelf to the table."""
    rng = script.layout.rng
    standing = [book for book in script.layout.named("Book") if book.relation == "inside"]
    book = standing[int(rng.integers(len(standing)))] if standing else None
    take = script.remove("Take a book from the shelf", book, 0.3)
    put = ""
    if book is not None and table is not None:
        width, depth = table.asset.surfaces["top"].size
        spot = rng.uniform(-0.25, 0.25, 2) * (width, depth)
        lying = turned(spot[0], spot[1], table.asset.surfaces["top"].center[2], float(rng.uniform(-1, 1)))
        put = script.insert(
            "Put it on the coffee table", book, table, lying, round(float(rng.uniform(0.15, 0.3)), 2), 180
        )
    return script.stage("Read", [take, put])


def _tidy(script: Script, table: Thing, remote: Thing, stand: Thing) -> LessonNode:
    """Cups off the table, the remote to the television, a cushion beaten; in any order."""
    rng = script.layout.rng
    cups = [script.remove("Clear a cup away", cup, 0.5) for cup in script.layout.named("Cup")[:3]]
    away = ""
    if stand is not None:
        place = turned(float(rng.uniform(-0.3, 0.3)), -0.1, stand.asset.surfaces["top"].center[2])
        away = script.insert("Put the remote before the television", remote, stand, place, 0.25, 180)
    cloth = _first(script.layout, "Cushion")
    beat = script.work(
        "Beat a cushion against the armchair", cloth, _first(script.layout, "Armchair"), int(rng.integers(2, 5))
    )
    group = script.group("Tidy up", table or stand, [*cups, away], "all" if rng.random() < 0.7 else "any")
    return script.stage("Tidy up", [group, beat], ordered=False, optional=[beat])

"""Small rooms as other people make them: their own names, no categories."""

from __future__ import annotations

from tests.meshes.shapes import box
from unisg_blender.scene import SceneBuilder, SceneGraph


def builder(title: str) -> SceneBuilder:
    """An empty room of 5 x 4 m, with a ground and four walls."""
    made = SceneBuilder(title)
    for name, size, corner in (
        ("Ground", (5.2, 4.2, 0.1), (-0.1, -0.1, -0.1)), ("N", (5.2, 0.1, 2.6), (-0.1, 4, 0)),
        ("S", (5.2, 0.1, 2.6), (-0.1, -0.1, 0)), ("E", (0.1, 4, 2.6), (5, 0, 0)), ("W", (0.1, 4, 2.6), (-0.1, 0, 0)),
    ):  # fmt: skip
        made.add(name, uid=name, mesh=box(size, corner))
    return made


def _with(made: SceneBuilder, things: dict[str, tuple[tuple[float, ...], tuple[float, ...]]]) -> SceneGraph:
    for name, (size, corner) in things.items():
        made.add(name, uid=name, mesh=box(size, corner))
    return made.build()


def kitchen() -> SceneGraph:
    """A kitchen: five of its six things have words of their own."""
    return _with(builder("kitchen"), {
        "Fridge.001": ((0.7, 0.7, 1.9), (0.0, 3.3, 0)), "SM_Stove_01": ((0.6, 0.6, 0.9), (0.8, 3.4, 0)),
        "kitchen_sink": ((0.8, 0.6, 0.9), (1.5, 3.4, 0)), "Table": ((1.4, 0.9, 0.75), (2.5, 1, 0)),
        "Stuhl_03": ((0.4, 0.4, 0.9), (2, 1, 0)), "Cube.007": ((0.5, 0.5, 0.9), (4.5, 0, 0)),
    })  # fmt: skip


def bedroom() -> SceneGraph:
    """A bedroom in three languages."""
    return _with(builder("bedroom"), {
        "Doppelbett": ((1.8, 2.0, 0.5), (1, 2, 0)), "comodino": ((0.4, 0.4, 0.5), (0.5, 3.6, 0)),
        "衣柜_01": ((1.0, 0.6, 2.0), (4, 0.05, 0)), "Nightstand": ((0.4, 0.4, 0.5), (2.9, 3.6, 0)),
    })  # fmt: skip


def parlour() -> SceneGraph:
    """A living room that lacks most of one."""
    return _with(builder("parlour"), {
        "Couch": ((2.0, 0.9, 0.8), (1, 3, 0)), "coffee_table": ((1.1, 0.6, 0.42), (1.4, 1.9, 0)),
        "TV_Bench": ((1.4, 0.4, 0.5), (1.3, 0.05, 0)),
    })  # fmt: skip


def house() -> SceneGraph:
    """Two rooms with a wall and a door between them: a kitchen to the west, a parlour, larger, to the east."""
    made = SceneBuilder("house")
    for name, size, corner in (
        ("ground", (11.2, 4.2, 0.1), (-0.1, -0.1, -0.1)), ("roof", (11.2, 4.2, 0.1), (-0.1, -0.1, 2.6)),
        ("n", (11.2, 0.1, 2.6), (-0.1, 4, 0)), ("s", (11.2, 0.1, 2.6), (-0.1, -0.1, 0)),
        ("e", (0.1, 4, 2.6), (11, 0, 0)), ("w", (0.1, 4, 2.6), (-0.1, 0, 0)),
        ("m1", (0.1, 3, 2.6), (4, 0, 0)), ("m2", (0.1, 1, 0.5), (4, 3, 2.1)),
    ):  # fmt: skip
        made.add(name, uid=name, mesh=box(size, corner))
    return _with(made, {
        "Fridge.001": ((0.7, 0.7, 1.9), (0.0, 0, 0)), "SM_Stove_01": ((0.6, 0.6, 0.9), (0.8, 0, 0)),
        "kitchen_sink": ((0.8, 0.6, 0.9), (1.5, 0, 0)), "toaster": ((0.3, 0.2, 0.2), (3.5, 0.2, 0)),
        "Couch": ((2, 0.9, 0.8), (6, 3, 0)), "tv": ((1.2, 0.1, 0.7), (6, 0.1, 0)),
        "coffee_table": ((1, 0.6, 0.4), (7, 2, 0)), "bookcase": ((0.9, 0.3, 1.9), (9.5, 3.6, 0)),
    })  # fmt: skip

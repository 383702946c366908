"""Cameras for a scene: its own, eyes of a person, corners of the room, looks from outside, or at things."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import deepcopy
from fnmatch import fnmatchcase

import numpy as np

from ...errors import UniSGError
from ...generate.counts import parse_counts
from ...geometry.arrays import Floats
from ...geometry.camera_view import CameraView, looking
from ...geometry.polygon import inside
from ...scene import SceneGraph
from .outside_views import DOLLHOUSE, TURNTABLE, from_outside
from .surround import EYE_HEIGHT, ChosenView, Surround

SCENE, EYE, CORNERS = "scene", "eye", "corners"
KINDS = (SCENE, EYE, CORNERS, DOLLHOUSE, TURNTABLE)
"""Kinds of views; any other word is a category of things to look at."""

HIGH = 2.3
"""Metres over the floor of cameras in corners."""

WIDE = 1.2
"""Angle of view in radians within a room."""

FROM_CORNER = 0.4
"""Metres that a camera keeps from both walls of a corner."""

WAYS = 12
"""Ways to look from each place of eyes."""


def parse_views(text: str) -> dict[str, int]:
    """Kinds of views and numbers out of "eye=4,corners=2,Chair=3"; UniSGError if the text is not of that form."""
    try:
        views = parse_counts(text)
    except UniSGError:
        views = {}
    if not views or 0 in views.values():
        raise UniSGError(f'--views must look like "eye=4,corners=2,Chair=1", each from 1 on, not {text[:100]!r}')
    return views


def choose_views(
    graph: SceneGraph,
    wanted: Mapping[str, int] | None,
    size: tuple[int, int],
    rng: np.random.Generator,
    source: SceneGraph | None = None,
) -> list[ChosenView]:
    """Cameras for a scene.

    Parameters
    ----------
    graph
        The scene, with the categories that may be looked at.
    wanted
        How many of which of :data:`KINDS`, or of looks at which category; where None, the scene's own cameras, two
        eyes where it has none, or two looks from outside where nobody can stand.
    size
        Width and height in pixels.
    source
        The same scene as it was read, where ``graph`` has categories that were made up: a house that is called "Cube"
        for its name is none of a user's things.

    Raises
    ------
    UniSGError
        If there is nothing to look at, nowhere to stand, or no such thing or camera.
    """
    own = scene_cameras(graph, size)
    around, found = Surround.of(graph, source or graph), list[ChosenView]()
    if wanted is None and own:
        wanted = {SCENE: len(own)}
    elif wanted is None:
        wanted = {EYE if len(around.standing_places(deepcopy(rng))) else DOLLHOUSE: 2}
    for kind, count in wanted.items():
        if kind == SCENE:
            if not own:
                raise UniSGError(
                    'the scene has no camera that can be used: add one, or ask for other views, such as "eye=2"'
                )
            found += [ChosenView(view, np.zeros(len(graph), bool)) for view in own[: max(count, 1)]]
        else:
            make = _MAKERS.get(kind, _looks_at)
            found += make(around, kind, count, size, rng)
    return found


def scene_cameras(graph: SceneGraph, size: tuple[int, int]) -> list[CameraView]:
    """The cameras of a scene, the active one first; panoramic ones are left out."""
    found = []
    for row, kind, fit, lens, width, height, scale, near, far, x, y, active in graph.entries(
        "camera", "kind", "fit", "lens", "sensor_width", "sensor_height", "ortho_scale", "clip_start", "clip_end",
        "shift_x", "shift_y", "active",
    ):  # fmt: skip
        if kind == "PANO":
            continue
        across = fit == "HORIZONTAL" or (fit == "AUTO" and size[0] >= size[1])
        side, sensor = size[0 if across else 1], height if fit == "VERTICAL" else width
        focal = side / scale if kind == "ORTHO" else lens / sensor * side
        center = (size[0] / 2 - x * side, size[1] / 2 + y * side)
        world = np.eye(4)
        axes = graph.world[row][:3, :3]
        world[:3, :3] = axes / np.linalg.norm(axes, axis=0)
        world[:3, 3] = graph.world[row][:3, 3]
        view = CameraView(
            f"camera {graph.name[row]}", world, size, float(focal), center, (float(near), float(far)), kind == "ORTHO"
        )
        found.append((not active, row, view))
    return [view for _, _, view in sorted(found, key=lambda entry: entry[:2])]


def _eyes(around: Surround, kind: str, count: int, size: tuple[int, int], rng: np.random.Generator) -> list[ChosenView]:
    """From where a person could stand, the way in which most is to be seen nearby."""
    places = around.standing_places(rng)
    if not len(places):
        raise UniSGError('there is nowhere to stand in the room: ask for "corners=1" or "dollhouse=1"')
    middles, height = around.middles, around.height(EYE_HEIGHT)
    turns = np.arange(WAYS) * 2 * np.pi / WAYS
    ways = np.column_stack([np.cos(turns), np.sin(turns)])
    offset = middles[None, :, :2] - places[:, None]
    far = np.maximum(np.linalg.norm(offset, axis=2), 1e-9)
    ahead = np.einsum("ptk,wk->pwt", offset / far[..., None], ways) > np.cos(0.45 * WIDE)
    ahead &= around.sees(places, middles[:, :2])[:, None, :]
    value = (ahead / np.maximum(far, 0.5)[:, None, :]).sum(axis=2)
    chosen = np.argsort(-value.max(axis=1), kind="stable")[: max(count, len(places) // 3)]
    chosen = rng.permutation(chosen)
    found = []
    for number in range(count):
        place = chosen[number % len(chosen)]
        way = np.argsort(-value[place], kind="stable")[number // len(chosen) % WAYS]
        seen = middles[ahead[place, way]]
        eye = np.array([*places[place], height])
        down = np.median(seen[:, 2]) if len(seen) else around.floor + 1.0
        target = np.array([*(places[place] + 2.0 * ways[way]), min(max(down, height - 1.2), height)])
        found.append(_within(f"{kind} {number}", eye, target, size, around))
    return found


def _corners(
    around: Surround, kind: str, count: int, size: tuple[int, int], rng: np.random.Generator
) -> list[ChosenView]:
    """From the corners of the room that are farthest from its things and see them."""
    target = around.middles[:, :2].mean(axis=0)
    if not inside(around.outline, target[None])[0]:
        target = around.inner
    places = _in_corners(around.outline)
    places = places[inside(around.outline, places)]
    clear = around.sees(places, target[None])[:, 0] if len(places) else np.zeros(0, bool)
    places = places[clear] if clear.any() else around.inner[None]
    order = np.argsort(-np.linalg.norm(places - target, axis=1), kind="stable")
    look = np.array([*target, around.floor + 0.7])
    return [
        _within(
            f"{kind} {number}", np.array([*places[order[number % len(order)]], around.height(HIGH)]), look, size, around
        )
        for number in range(count)
    ]


def _in_corners(outline: Floats) -> Floats:
    """Places (K, 2) within the corners of an outline, as far from both walls."""
    before, after = np.roll(outline, 1, axis=0) - outline, np.roll(outline, -1, axis=0) - outline
    ways = [way / np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-9) for way in (before, after)]
    return outline + FROM_CORNER * (ways[0] + ways[1])


def _within(name: str, eye: Floats, target: Floats, size: tuple[int, int], around: Surround) -> ChosenView:
    return ChosenView(looking(name, eye, target, size, WIDE, around.clip()), np.zeros(len(around.graph), bool))


def _looks_at(
    around: Surround, kind: str, count: int, size: tuple[int, int], rng: np.random.Generator
) -> list[ChosenView]:
    """At things of a category, from where a person could stand, else from close above."""
    graph, objects = around.graph, around.objects
    mine = [
        number for number, row in enumerate(objects.rows.tolist())
        if fnmatchcase(graph.category_name(row).casefold(), kind.casefold())
    ]  # fmt: skip
    if not mine:
        raise UniSGError(f"there is no {kind!r} in the scene to look at (views are {', '.join(KINDS)}, or a category)")
    places, order, found = around.standing_places(rng), rng.permutation(mine), []
    for number in range(count):
        thing = order[number % len(order)]
        middle = (objects.low[thing] + objects.high[thing]) / 2
        long = float(np.linalg.norm(objects.high[thing] - objects.low[thing]))
        far = np.linalg.norm(places - middle[:2], axis=1)
        near = np.argsort(np.abs(far - max(1.0, 1.5 * long)), kind="stable")[:5]
        if len(near):
            eye = np.array([*places[rng.choice(near)], around.height(EYE_HEIGHT)])
        else:
            eye = middle + np.array([0.3, -0.8, 0.8]) * max(long, 0.5)
        angle = float(np.clip(2.5 * long / max(float(np.linalg.norm(eye - middle)), 0.1), 0.35, WIDE))
        view = looking(f"{kind} {number}", eye, middle, size, angle, around.clip())
        found.append(ChosenView(view, np.zeros(len(graph), bool)))
    return found


Maker = Callable[[Surround, str, int, tuple[int, int], np.random.Generator], list[ChosenView]]
_MAKERS: dict[str, Maker] = {EYE: _eyes, CORNERS: _corners, DOLLHOUSE: from_outside, TURNTABLE: from_outside}

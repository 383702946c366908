"""Pictures of held-out rooms from above: what was taken out, and where the trees would put it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from ...generate.observe.observed_scene import ObservedScene
from ...generate.observe.prior_tables import PriorTables
from ...generate.propose.trees_proposer import TreesProposer
from ...geometry.arrays import Bools, Floats
from .held_out import Choice, taken_out

DRAWN = 24
"""Draws of each thing that are shown."""

WIDE, EDGE = 340, 8
"""Pixels of a picture's longer side, and around the room."""

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00")
"""Of the things that were taken out, told apart by colour-blind people, too (Okabe and Ito 2008)."""


@dataclass(frozen=True, eq=False)
class AskedAgain:
    """A thing that was taken out: its footprint (4, 2) at the true place, and at the draws (D, 4, 2)."""

    name: str
    true: Floats
    drawn: Floats


@dataclass(frozen=True, eq=False)
class Completion:
    """A held-out room: footprints (K, 4, 2) of what stayed, which of it is building, and what was asked for."""

    stayed: Floats
    building: Bools
    asked: tuple[AskedAgain, ...]


def completion_of(
    proposer: TreesProposer,
    scene: ObservedScene,
    tables: PriorTables,
    chosen: Mapping[str, Choice],
    rng: np.random.Generator,
) -> Completion:
    """Take things out of a room, and draw places for each as the chosen ways do, before they are settled."""
    rest, asked = scene, []
    vocabulary = proposer.model.contract.vocabulary
    for one in taken_out(scene, tables, vocabulary, rng):
        rest, power = one.query.scene, chosen[one.group].power
        draw = proposer.bootstrapped(one.query, DRAWN, rng) if power is None else proposer.drawn(
            one.query, DRAWN, rng, power
        )  # fmt: skip
        places = np.concatenate([one.true[None], draw.places])
        shapes = footprints(places[:, :2], np.tile(scene.half[one.obj], (len(places), 1)), places[:, 3])
        asked.append(AskedAgain(vocabulary[scene.category[one.obj]], shapes[0], shapes[1:]))
    structural = np.append(tables.structural, False)
    return Completion(footprints(rest.center, rest.half, rest.yaw), structural[rest.category], tuple(asked))


def footprints(center: Floats, half: Floats, yaw: Floats) -> Floats:
    """Corners (N, 4, 2) of upright boxes from above, of centres (N, 2 or 3), half sizes (N, 3) and turns (N,)."""
    corners = half[:, None, :2] * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    cos, sin = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
    turned = np.stack(
        [corners[..., 0] * cos - corners[..., 1] * sin, corners[..., 0] * sin + corners[..., 1] * cos], -1
    )
    return np.asarray(turned + center[:, None, :2])


def completion_svg(completion: Completion) -> str:
    """The room as a picture for a page: true places outlined, draws filled, a name at each."""
    shapes = [completion.stayed, *(one.true[None] for one in completion.asked)]
    points = np.concatenate([shape.reshape(-1, 2) for shape in shapes])
    low, high = points.min(axis=0), points.max(axis=0)
    scale = WIDE / max(float((high - low).max()), 1e-6)

    def polygon(corners: Floats, style: str) -> str:
        """A footprint (4, 2), metres, in the picture."""
        x, y = (corners[:, 0] - low[0]) * scale, (high[1] - corners[:, 1]) * scale
        path = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))
        return f'<polygon points="{path}" style="{style}"/>'

    parts = [
        polygon(corners, f"fill:{'#eee' if building else '#ddd'};stroke:#999")
        for corners, building in sorted(
            zip(completion.stayed, completion.building.tolist(), strict=True), key=lambda pair: not pair[1]
        )
    ]
    for one, color in zip(completion.asked, _colors(len(completion.asked)), strict=True):
        parts += [polygon(corners, f"fill:{color};fill-opacity:0.12;stroke:none") for corners in one.drawn]
    for one, color in zip(completion.asked, _colors(len(completion.asked)), strict=True):
        parts.append(polygon(one.true, f"fill:none;stroke:{color};stroke-width:2;stroke-dasharray:4 3"))
        x, y = (one.true.mean(axis=0) - low) * scale
        top = (high[1] - low[1]) * scale - y
        parts.append(f'<text x="{x:.1f}" y="{top:.1f}" style="{TEXT};fill:{color}">{escape(one.name)}</text>')
    width, height = (high - low) * scale + 2 * EDGE
    moved = f'<g transform="translate({EDGE} {EDGE})">{"".join(parts)}</g>'
    return f'<svg width="{width:.0f}" height="{height:.0f}">{moved}</svg>'


TEXT = "font:11px sans-serif;text-anchor:middle;paint-order:stroke;stroke:#fff;stroke-width:3px"


def _colors(count: int) -> Sequence[str]:
    return [COLORS[number % len(COLORS)] for number in range(count)]

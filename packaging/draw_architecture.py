"""Draw the house from its imports, layers as bands, rooms as boxes, arrows downward; and write the table of arrows.

    python packaging/draw_architecture.py

Writes docs/pictures/architecture.svg and .png, the same bytes for the same imports, and the table in
docs/architecture.md. An arrow that follows from others is not drawn (learn needs predict, and predict needs dataset,
so the one from learn to dataset is left out). Needs matplotlib.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path as FilePath

import matplotlib
from architecture import ARROWS, LAYERS, ROOT, modules, room_arrows

matplotlib.use("agg")
from matplotlib import pyplot
from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch, FancyBboxPatch, Rectangle
from matplotlib.path import Path

WIDTH = 12.0
STEP = 1.02  # from layer to layer
HEIGHT = 0.66  # of a box
# Centre and width of each box; the height follows from its layer.
PLACES: dict[str, tuple[float, float]] = {
    "panels": (3.6, 2.2),
    "operators": (3.6, 2.2),
    "cli": (3.2, 1.4),
    "commands": (8.6, 3.4),
    "batches": (8.6, 3.0),
    "experiments": (8.6, 4.0),
    "learn": (8.7, 6.1),
    "metrics": (8.4, 2.2),
    "predict": (4.2, 2.0),
    "generate": (8.4, 3.4),
    "dataset": (8.4, 3.0),
    "formats": (4.2, 1.8),
    "web": (5.85, 1.2),
    "usd": (2.35, 1.1),
    "blender": (4.75, 3.5),
    "interactivity": (7.3, 1.6),
    "meshes": (8.95, 1.3),
    "worlds": (10.7, 1.5),
    "behaviour": (5.3, 2.6),
    "spatial": (10.4, 2.0),
    "words": (7.7, 1.6),
    "scene": (6.0, 2.8),
    "geometry": (9.4, 2.2),
    "poses": (7.3, 2.2),
    "runtime": (4.7, 2.2),
    "pretrained": (7.3, 2.2),
    "errors": (9.9, 2.2),
}
# Where an arrow that passes other layers runs straight down between their boxes.
LANES: dict[tuple[str, str], float] = {
    ("commands", "experiments"): 10.4,
    ("batches", "generate"): 5.5,
    ("batches", "worlds"): 11.75,
    ("commands", "web"): 5.85,
    ("operators", "worlds"): 11.45,
    ("operators", "predict"): 4.3,
    ("operators", "generate"): 4.75,
    ("learn", "predict"): 6.2,
    ("learn", "worlds"): 10.9,
    ("predict", "meshes"): 5.85,
    ("dataset", "spatial"): 9.5,
    ("usd", "scene"): 3.2,
    ("meshes", "scene"): 6.95,
    ("meshes", "geometry"): 7.7,
}
COLOURS = ["#e3edf6", "#e9f1e1", "#f8f0de", "#f5e7e9", "#eae6f4"]
BANDS = [0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 3, 3, 4, 4, 4, 4]  # the colour of each layer


def needed_arrows(pairs: set[tuple[str, str]]) -> set[tuple[str, str]]:
    """The arrows that do not follow from others (transitive reduction of a graph without circles)."""
    reach: dict[str, set[str]] = {}

    def below(room: str) -> set[str]:
        if room not in reach:
            direct = {b for a, b in pairs if a == room}
            reach[room] = direct.union(*map(below, direct))
        return reach[room]

    return {(a, b) for a, b in pairs if not any(b in below(c) for x, c in pairs if x == a and c != b)}


def size_text(room: str) -> tuple[str, str]:
    """The folders inside a room, and how many files and lines it has."""
    inside = [m for m in modules().values() if m.room == room]
    folders = sorted({m.steps[1] for m in inside if len(m.steps) > 2 or (len(m.steps) == 2 and m.is_package)})
    lines = sum(m.source.count("\n") for m in inside)
    size = f"{len(inside)} file{'s' * (len(inside) > 1)}, {round(lines, -1 if lines < 1000 else -2):,} lines"
    return " · ".join(folders), size


def draw_box(axes: Axes, room: str, top: float) -> None:
    """One room: name, folders, size."""
    centre, width = PLACES[room]
    corner = (centre - width / 2, top - HEIGHT)
    shape = "round,pad=0,rounding_size=0.08"
    axes.add_patch(FancyBboxPatch(corner, width, HEIGHT, shape, facecolor="white", edgecolor="#444444", zorder=3))
    folders, size = size_text(room)
    lines = [(room, 11, "bold", "#111111"), (folders, 7.4, "normal", "#333333"), (size, 7.4, "normal", "#666666")]
    heights = [0.16, 0.36, 0.53] if folders else [0.22, 0.36, 0.46]
    for (text, points, weight, ink), down in zip(lines, heights, strict=True):
        look = {"fontsize": points, "weight": weight, "color": ink}
        axes.text(centre, top - down, text, ha="center", va="center", zorder=4, **look)


def draw(out: FilePath) -> None:
    """Write both pictures into the folder."""
    matplotlib.rcParams |= {"svg.hashsalt": "architecture", "font.family": "DejaVu Sans"}
    levels = {room: level for level, rooms in enumerate(LAYERS.values()) for room in rooms}
    tops = {room: -STEP * level for room, level in levels.items()}
    figure, axes = pyplot.subplots(figsize=(WIDTH, STEP * len(LAYERS)))
    for level, (name, rooms) in enumerate(LAYERS.items()):
        colour = COLOURS[BANDS[level]]
        corner = (0, 0.18 - STEP * (level + 1))
        axes.add_patch(Rectangle(corner, WIDTH, STEP, facecolor=colour, edgecolor="white", linewidth=1.5, zorder=0))
        axes.text(0.15, -STEP * level - HEIGHT / 2, name, fontsize=8.5, style="italic", color="#555555", va="center")
        for room in rooms:
            draw_box(axes, room, -STEP * level)
    draw_arrows(axes, tops)
    axes.set(xlim=(0, WIDTH), ylim=(-STEP * len(LAYERS) + 0.18, 0.18), aspect="equal")
    axes.axis("off")
    figure.subplots_adjust(0, 0, 1, 1)
    for ending in ("svg", "png"):
        figure.savefig(out / f"architecture.{ending}", dpi=110, metadata={"Date": None} if ending == "svg" else None)
    pyplot.close(figure)


def draw_arrows(axes: Axes, tops: dict[str, float]) -> None:
    """The needed arrows, spread along the edges of their boxes in the order of their other ends."""
    arrows = needed_arrows({(a, b) for a, b in room_arrows() if b in ARROWS[a]})  # a circle cannot be drawn downward
    start: dict[tuple[str, str], float] = {}
    end: dict[tuple[str, str], float] = {}
    for room, (centre, width) in PLACES.items():
        for ports, number in ((start, 0), (end, 1)):
            pairs = [pair for pair in arrows if pair[number] == room]
            pairs.sort(key=lambda pair, other=1 - number: LANES.get(pair, PLACES[pair[other]][0]))
            for place, pair in enumerate(pairs, start=1):
                ports[pair] = centre + 0.9 * width * (place / (len(pairs) + 1) - 0.5)
    for a, b in sorted(arrows):
        path = arrow_path((start[a, b], tops[a] - HEIGHT), (end[a, b], tops[b]), LANES.get((a, b)))
        axes.add_patch(
            FancyArrowPatch(path=path, arrowstyle="-|>", mutation_scale=10, color="#35506b", linewidth=1.2, zorder=2)
        )


def arrow_path(start: tuple[float, float], end: tuple[float, float], lane: float | None) -> Path:
    """From a box down to another one: one bend, or a bend into the lane, straight down, and a bend out of it."""
    gap = STEP - HEIGHT
    stops = [start] if lane is None else [start, (lane, start[1] - gap), (lane, end[1] + gap)]
    points, codes = [start], [Path.MOVETO]
    for (x, y), (to_x, to_y) in pairwise([*stops, end]):
        middle = (y + to_y) / 2
        points += [(x, middle), (to_x, middle), (to_x, to_y)]
        codes += [Path.CURVE4] * 3
    return Path(points, codes)


def write_table(page: FilePath) -> None:
    """Put the table of arrows between its two marks in a page."""
    order = [room for rooms in LAYERS.values() for room in rooms]
    targets = {room: ", ".join(f"`{each}`" for each in order if each in ARROWS[room]) for room in ARROWS}
    rows = [f"| `{room}` | {targets[room]} |" for room in order if room in targets]
    before, _, rest = page.read_text(encoding="utf-8").partition("<!-- arrows -->")
    after = rest.partition("<!-- end -->")[2]
    table = "\n".join(["| room | imports |", "|---|---|", *rows])
    page.write_text(f"{before}<!-- arrows -->\n{table}\n<!-- end -->{after}", encoding="utf-8")


if __name__ == "__main__":
    draw(ROOT / "docs/pictures")
    write_table(ROOT / "docs/architecture.md")

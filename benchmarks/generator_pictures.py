"""Pictures of rooms furnished anew, beside the real ones: ``python benchmarks/generator_pictures.py MODEL --out DIR``.

From above, coloured by category, without what hangs from the ceiling. Needs Blender's Python module.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import bpy
from PIL import Image

from unisg_blender.blender import new_file, write_scene
from unisg_blender.blender.render.picture import render_picture
from unisg_blender.experiments.rooms.atiss_proposer import load_generator
from unisg_blender.experiments.rooms.cases import case_of
from unisg_blender.experiments.rooms.furnishing import ByModel
from unisg_blender.scene import SceneGraph
from unisg_blender.worlds import WORLDS

SIZE = (620, 560)
HIDDEN = ("Ceiling Rail", "Surgical Lamp")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("model", type=Path, nargs="+", help="generators, one row of pictures each")
    parser.add_argument("--world", default="operating-room")
    parser.add_argument("--seeds", type=int, nargs="+", default=[100_000, 100_001, 100_002])
    parser.add_argument("--raw", action="store_true", help="first proposals as they are")
    parser.add_argument("--out", type=Path, required=True, help="PNG file: real rooms above, then a row for each model")
    args = parser.parse_args()
    ways = [ByModel(load_generator(path), not args.raw) for path in args.model]
    pictures = []
    for seed in args.seeds:
        real = WORLDS[args.world](seed)
        column = [real]
        for way in ways:
            case = case_of(real, way.generator.categories)
            assert case is not None
            column.append(way.furnish(case, seed).scene)
        pictures.append([_picture(graph, args.out.with_suffix(".part.png")) for graph in column])
    sheet = Image.new("RGB", (SIZE[0] * len(pictures), SIZE[1] * len(pictures[0])))
    for x, column_of in enumerate(pictures):
        for y, image in enumerate(column_of):
            sheet.paste(image, (x * SIZE[0], y * SIZE[1]))
    sheet.save(args.out)


def _picture(graph: SceneGraph, path: Path) -> Image.Image:
    new_file()
    write_scene(graph, bpy.context.scene)
    render_picture(path, view="top", size=SIZE, leave_out=HIDDEN, by_category=True)
    image = Image.open(path).convert("RGB")
    path.unlink()
    return image


if __name__ == "__main__":
    main()

"""Proposed categories of things that nobody labelled: how often right, how well calibrated, and what is not known.

    python benchmarks/proposals.py MESHES ... [--collada FOLDER ...] --foreign SCENES --out docs/results/proposals.json

None of the furniture that is asked for was learned from. SCENES has scenes of characters, game pieces and
machines. Names are left out: the shape alone counts.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from itertools import chain
from pathlib import Path

import numpy as np
from foreign_assets import read_assets

from unisg_blender.errors import UniSGError
from unisg_blender.experiments.reports import markdown_table, write_results
from unisg_blender.formats import read_scene_file
from unisg_blender.geometry.arrays import Bools, Floats
from unisg_blender.predict import LabelModel, Proposal, propose_categories
from unisg_blender.predict.calibration import KNOWN
from unisg_blender.scene import Mesh, SceneBuilder, mesh_from_faces
from unisg_blender.spatial.object_rows import find_objects

BINS = 5
SCENES = (
    "bevyengine+bevy/assets/models/AlienCake/alien.glb", "bevyengine+bevy/assets/models/AlienCake/cakeBirthday.glb",
    "armory3d+armory_examples/physics_ragdoll/physics_ragdoll.blend",
    "armory3d+armory_examples/animation_bonechild/animation_bonechild.blend",
    "godotengine+godot-demo-projects/viewport/3d_in_2d/robot.glb",
    "godotengine+godot-demo-projects/3d/squash_the_creeps/art/player.blend",
    "usd-wg+assets/test_assets/USDZ/RiggedFigure/RiggedFigure.usdz",
    "usd-wg+assets/full_assets/OpenChessSet/chess_set.usda", "usd-wg+assets/full_assets/Teapot/Teapot.usd",
    "usd-wg+assets/full_assets/StandardShaderBall/standard_shader_ball_scene.usda",
    "dfki-ric+phobos/models/simple_walker.blend",
    "saturday06+VRM-Addon-for-Blender/tests/resources/blend/lossless_animation/hips_rotation.blend",
)  # fmt: skip
SETS: dict[str, tuple[str, ...]] = {
    "held-out models of makers learned from": (),
    "furniture of robots' worlds": ("gazebo",),
    "furniture of simulated buildings": ("aws",),
}
"""What is asked for, by maker; without a maker, split "test" of what was learned from."""
ALL = "all"
FLAT = 1e-3
PLAIN = ("plane", "cube", "back", "front", "left", "right", "top", "ground", "backplane")
"""Names of planes, cubes and backdrops: they are no shapes of anything."""


def foreign_shapes(folder: Path) -> Iterator[Mesh]:
    """The different shapes of the scenes that no furniture has."""
    for name in SCENES:
        try:
            graph, _ = read_scene_file(folder / name)
        except UniSGError as error:
            print(error)
            continue
        objects = find_objects(graph, empty=False)
        seen = set()
        for obj in range(len(objects)):
            meshes = tuple(graph.mesh[objects.meshes[obj]])
            plain = graph.name[objects.rows[obj]].split(".")[0].casefold() in PLAIN
            if meshes in seen or plain or (objects.high[obj] - objects.low[obj]).min() < FLAT:
                continue
            seen.add(meshes)
            triangles = objects.triangles(obj)
            yield mesh_from_faces("m", triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3))


def proposal(mesh: Mesh) -> Proposal:
    """What one mesh is proposed to be, by its shape and size."""
    builder = SceneBuilder("one")
    builder.add("Object", uid="u", mesh=mesh)
    return propose_categories(builder.build(), use=("shape",))[0]


def calibration_error(confidence: Floats, right: Bools) -> float:
    """Expected calibration error over bins of as many things each."""
    parts = np.array_split(np.argsort(confidence, kind="stable"), BINS)
    return float(sum(len(p) * abs(confidence[p].mean() - right[p].mean()) for p in parts) / len(confidence))


def percent(values: Floats | Bools | list[bool]) -> float:
    """The mean, in percent; 0 of nothing."""
    return round(100 * float(np.mean(values)), 1) if len(values) else 0.0


def reliability(confidence: Floats, right: Bools) -> list[dict[str, float]]:
    """What was said and what was right, bin by bin."""
    parts = np.array_split(np.argsort(confidence, kind="stable"), BINS)
    return [
        {
            "things": len(p),
            "said": round(100 * float(confidence[p].mean()), 1),
            "right": round(100 * float(right[p].mean()), 1),
        }
        for p in parts
    ]


def measured(found: list[Proposal], truth: list[str]) -> dict[str, float]:
    """How often right, calibrated, and known."""
    confidence = np.array([one.confidence for one in found])
    right = np.array([one.best == thing for one, thing in zip(found, truth, strict=True)])
    three = [thing in dict(one.categories) for one, thing in zip(found, truth, strict=True)]
    known = np.array([one.known for one in found])
    rng = np.random.default_rng(0)
    chance = [calibration_error(confidence, rng.random(len(found)) < confidence) for _ in range(500)]
    return {
        "things": len(found), "top_1": percent(right), "top_3": percent(three), "said": percent(confidence),
        "calibration_error": round(calibration_error(confidence, right), 3),
        "of_a_perfect_one": round(float(np.mean(chance)), 3), "known": percent(known),
        "right_of_known": percent(right[known]),
    }  # fmt: skip


def draw(bins: list[dict[str, float]], path: Path) -> None:
    """The reliability diagram: what was said against what was right, percent."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure((3.2, 3.2), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot(
        xlabel="said, percent", ylabel="right, percent", xlim=(0, 100), ylim=(0, 100), aspect="equal"
    )
    axes.plot([0, 100], [0, 100], color="0.7", linewidth=1)
    axes.plot([b["said"] for b in bins], [b["right"] for b in bins], "o-", color="#2a6f97")
    figure.savefig(path, dpi=100)


def main() -> None:
    """Propose for all, print, write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meshes", type=Path, nargs="+")
    parser.add_argument("--collada", type=Path, nargs="*", default=[])
    parser.add_argument("--foreign", type=Path, required=True)
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    vocabulary, assets = LabelModel.load().vocabulary, read_assets(args.meshes, args.collada)
    asked = {
        name: [a for a in assets if a.thing in vocabulary and (a.maker in makers if makers else a.split == "test")]
        for name, makers in SETS.items()
    }
    found = {name: [proposal(asset.mesh) for asset in mine] for name, mine in asked.items()}
    truth = {name: [asset.thing for asset in mine] for name, mine in asked.items()}
    found[ALL], truth[ALL] = [*chain(*found.values())], [*chain(*truth.values())]
    rows = [{"set": name, **measured(found[name], truth[name])} for name in found]
    foreign = {
        "held-out categories": [proposal(a.mesh) for a in assets if a.split == "unseen"],
        "people, animals, vehicles, food": [proposal(a.mesh) for a in assets if a.maker == "foreign"],
        "characters, game pieces, machines": [proposal(mesh) for mesh in foreign_shapes(args.foreign)],
    }
    unknown = [
        {"set": name, "shapes": len(mine), "not_known": percent([not p.known for p in mine])}
        for name, mine in {**foreign, ALL: [*chain(*foreign.values())]}.items()
    ]
    sure, right = np.array([p.confidence for p in found[ALL]]), np.array([p.best for p in found[ALL]]) == truth[ALL]
    for table in (rows, unknown, bins := reliability(sure, right)):
        print(markdown_table(list(table[0]), [list(map(str, row.values())) for row in table]))
    if args.out:
        record = {"proposals": rows, "foreign": unknown, "reliability": bins, "known_from": KNOWN}
        write_results(args.out, record)
        draw(bins, args.out.with_suffix(".png"))


if __name__ == "__main__":
    main()

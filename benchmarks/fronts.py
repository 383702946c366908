"""Which side is the front: how often the shape tells it right, of assets of others and of our own worlds.

    python benchmarks/fronts.py MESHES ... [--collada FOLDER ...] [--fit] --out docs/results/fronts.json

Each asset is judged in four quarter turns.
``--fit`` fits ``pretrained/fronts.json`` on the seen two thirds first.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import numpy as np
from foreign_assets import ForeignAsset, read_assets
from scipy.optimize import minimize

from unisg_blender.experiments.reports import markdown_table, write_results
from unisg_blender.geometry.arrays import Floats
from unisg_blender.geometry.planar import rotation
from unisg_blender.spatial.fronts import FEATURES, SIDES, WEIGHTS_FILE, front_of, side_features
from unisg_blender.spatial.object_rows import find_objects
from unisg_blender.worlds import WORLDS

LIGHTLY = 1e-3
UNSEEN_MAKERS = ("quaternius", "gazebo")


def fit(assets: list[ForeignAsset]) -> dict[str, float]:
    """Weights by feature, by a choice among the four sides (conditional logit)."""
    inputs = np.array([side_features(asset.triangles) for asset in assets])
    truth = np.array([[side in asset.fronts for side in SIDES] for asset in assets], float)
    scale = inputs.reshape(-1, inputs.shape[2]).std(axis=0) + 1e-6

    def loss(weights: Floats) -> float:
        score = inputs / scale @ weights
        score = score - score.max(axis=1, keepdims=True)
        chance = np.exp(score) / np.exp(score).sum(axis=1, keepdims=True)
        return float(-np.log((chance * truth).sum(axis=1)).mean() + LIGHTLY * weights @ weights)

    weights = minimize(loss, np.zeros(inputs.shape[2]), method="L-BFGS-B").x / scale
    return dict(zip(FEATURES, weights.round(4).tolist(), strict=True))


def judged(assets: list[ForeignAsset]) -> dict[str, float]:
    """Of assets with a front, each in four quarter turns: how often it is right, told, and right where it is told."""
    right, told = [], []
    for asset in assets:
        for turns in range(4):
            front = front_of(asset.triangles @ rotation(turns * np.pi / 2).T)
            right.append(SIDES[(front.side - turns) % 4] in asset.fronts)
            told.append(front.told)
    sure = np.array(right)[np.array(told)]
    return {
        "assets": len(assets), "right": round(100 * float(np.mean(right)), 1),
        "told": round(100 * float(np.mean(told)), 1), "right_where_told": round(100 * float(sure.mean()), 1),
    }  # fmt: skip


def own_worlds(rooms: int = 4) -> dict[str, int]:
    """Of the large things of our own rooms, none of which was fitted on and all of which look towards -y."""
    counts = {"things": 0, "told": 0, "told_wrong": 0}
    for name in ("operating-room", "living-room"):
        for seed in range(rooms):
            objects = find_objects(WORLDS[name](seed), empty=False)
            for obj in range(len(objects)):
                triangles = objects.triangles(obj) @ rotation(-float(objects.yaw[obj])).T
                if max(np.ptp(triangles, axis=(0, 1))[:2]) < 0.3:
                    continue
                front = front_of(triangles)
                counts["things"] += 1
                counts["told"] += front.told
                counts["told_wrong"] += front.told and front.side != 0
    return counts


def main() -> None:
    """Fit if asked, measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("meshes", type=Path, nargs="+")
    parser.add_argument("--collada", type=Path, nargs="*", default=[])
    parser.add_argument("--fit", action="store_true")
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    assets = read_assets(args.meshes, args.collada)
    fronted = [asset for asset in assets if asset.fronts]
    if args.fit:
        WEIGHTS_FILE.write_text(json.dumps({"weights": fit([a for a in fronted if not a.unseen])}, indent=1) + "\n")
    start = time.process_time()
    rows = [{"set": "seen", **judged([a for a in fronted if not a.unseen])}]
    rows.append({"set": "unseen", **judged([a for a in fronted if a.unseen])})
    strange = [a for a in fronted if a.maker in UNSEEN_MAKERS]
    rows.append({"set": "of these, of makers never seen", **judged(strange)})
    spent = 1000 * (time.process_time() - start) / (4 * len(fronted))
    print(markdown_table(list(rows[0]), [list(map(str, row.values())) for row in rows]))
    table = {"marked": len(assets), "symmetric": len(assets) - len(fronted), "milliseconds": round(spent, 1)}
    own = own_worlds()
    print(table, own)
    if args.out:
        write_results(args.out, {"fronts": rows, "own": own, **table})


if __name__ == "__main__":
    main()

"""What the shipped generators make of a few rooms of the benchmark, recorded: ``python -m tests.generate.recorded``."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

from unisg_blender.experiments.behaviour.behaviour_benchmark import compare_behaviour
from unisg_blender.experiments.rooms.cases import case_of
from unisg_blender.experiments.rooms.furnishing import ByModel
from unisg_blender.generate import Generator
from unisg_blender.metrics.scene_validity import measure_scene
from unisg_blender.worlds import WORLDS

PRETRAINED = Path(__file__).parents[2] / "unisg_blender" / "pretrained"
FILE = Path(__file__).with_name("recorded.json")
ROOMS, FIRST, BEHAVIOUR_ROOMS = 6, 100_000, 5
COUNTS = ("objects", "colliding", "overlapping", "off_support", "outside", "refused")


def models() -> dict[str, str]:
    """World by name of each shipped generator."""
    worlds = {"operating_room": "operating-room", "living_room": "living-room"}
    return {name: world for name, world in worlds.items() if (PRETRAINED / f"{name}.onnx").is_file()}


def digest_of(name: str) -> str:
    return hashlib.sha256((PRETRAINED / f"{name}.onnx").read_bytes()).hexdigest()


def measured(name: str, settle: bool) -> dict[str, int]:
    """Faults in :data:`ROOMS` rooms furnished anew, in all."""
    way = ByModel(Generator.load(PRETRAINED / f"{name}.onnx"), settle)
    total = dict.fromkeys(COUNTS, 0)
    for number in range(ROOMS):
        case = case_of(WORLDS[models()[name]](FIRST + number), way.generator.categories)
        assert case is not None
        made = way.furnish(case, number)
        report = measure_scene(made.scene)
        columns = (report.counted, report.colliding, report.overlapping, report.off_support, report.outside)
        for key, value in zip(COUNTS, (*(int(column.sum()) for column in columns), made.refused), strict=True):
            total[key] += value
    return total


def behaviour_rows(name: str) -> list[dict[str, Any]]:
    """The table of behaviour for some rooms, without its times."""
    generator = Generator.load(PRETRAINED / f"{name}.onnx")
    graphs = [WORLDS[models()[name]](FIRST + number) for number in range(BEHAVIOUR_ROOMS)]
    rows = [row.to_record() for row in compare_behaviour(generator, graphs, play=2)]
    return [{key: value for key, value in row.items() if key != "milliseconds"} for row in rows]


def main() -> None:
    record = {
        name: {
            "sha256": digest_of(name),
            "rooms": ROOMS,
            "raw": measured(name, settle=False),
            "settled": measured(name, settle=True),
            "behaviour": behaviour_rows(name),
        }
        for name in models()
    }
    FILE.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    print(json.dumps(record, indent=1))


if __name__ == "__main__":
    main()

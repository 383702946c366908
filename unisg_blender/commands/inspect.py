"""``unisg inspect``: the entity tree of a scene file, or the contents of a dataset."""

from __future__ import annotations

import argparse
import json
from typing import Any

from ..errors import DONE, UniSGError
from .argument_types import PATH
from .common import (
    add_limit,
    add_mapping,
    add_scene_options,
    print_report,
    read_shown,
    shown_lines,
    tell_lost,
    words_of,
)
from .given_scenes import check_mapping, is_dataset
from .outputs import check_results

HELP = "Show the entity tree of a scene file, with components and behaviour, or the contents of a dataset."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    parser.add_argument("path", metavar="FILE_OR_DATASET", type=PATH, help="a scene file, or the folder of a dataset")
    add_scene_options(parser)
    add_mapping(parser)
    add_limit(parser, "lines of each kind: entities, parts of the lesson, relations")
    parser.add_argument(
        "--structure", action="store_true", help="show floors, rooms, walls, openings and surfaces, told by geometry"
    )
    parser.add_argument(
        "--plan", type=PATH, metavar="PICTURE", help="draw this structure from above, a storey each (.svg, .png, .pdf)"
    )
    parser.add_argument(
        "--words", metavar="MODEL", help="show what a model understands of names and categories, and how foreign it is"
    )
    parser.add_argument("--figures", type=PATH, metavar="DIR", help="of a dataset: write pictures to this folder")


def run(args: argparse.Namespace) -> int:
    """Print the tree, or with ``--json`` everything as one JSON object."""
    check_results("--figures", args.figures, [args.path])
    _check_options(args)
    if args.path.is_dir():
        return _inspect_dataset(args)
    if args.structure or args.plan is not None:
        return _inspect_structure(args)
    if args.words is not None:
        return _inspect_words(args)
    from ..scene.lesson_node import lesson_to_json
    from ..scene.scene_text import entity_lines, lesson_lines, relation_lines, summary, to_records

    graph, lost = read_shown(args, args.path, geometry=args.geometry, scene=args.scene)
    if args.json:
        lessons = [json.loads(lesson_to_json(operation)) for _, operation in graph.entries("lsa", "data")]
        record = {"file": str(args.path), **summary(graph), "records": to_records(graph), "lessons": lessons}
        record["not_represented"] = list(lost)
        print(json.dumps(record, ensure_ascii=False))
        return DONE
    print("\n".join(shown_lines(args, entity_lines(graph), "entities")))
    for lines, things in ((lesson_lines(graph), "parts of the lesson"), (relation_lines(graph), "relations")):
        if lines:
            print("\n".join(shown_lines(args, lines, things)))
    if not args.quiet:
        print("\n" + "\n".join(_summary_lines(summary(graph))))
    tell_lost(args, lost)
    return DONE


def _check_options(args: argparse.Namespace) -> None:
    """Refuse options that would change nothing of what is shown."""
    if not args.path.is_dir():
        if args.figures is not None:
            raise UniSGError(f"--figures draws datasets, and {args.path} is none: --plan FILE draws a scene")
        if args.words is not None and (args.structure or args.plan is not None):
            raise UniSGError("--words and --structure show different things: give one of them")
        return
    if not is_dataset(args.path):
        raise UniSGError(
            f"{args.path} holds no dataset: name a scene file in it, or make a dataset with "
            f"'unisg export {args.path} --out DATASET'"
        )
    check_mapping(args, [args.path])
    if given := [name for name in ("structure", "plan", "words", "scene") if getattr(args, name)]:
        raise UniSGError(f"--{given[0]} looks at a scene file, and {args.path} is a dataset")


def _inspect_structure(args: argparse.Namespace) -> int:
    """What is building in the scene, for ``--structure`` and ``--plan``."""
    from ..generate.observe.named_rooms import room_names
    from ..spatial.structure import recognise_structure
    from ..spatial.structure.plan_picture import check_plan, draw_plan
    from ..spatial.structure.structure_text import structure_lines, structure_record

    if args.plan is not None:
        check_plan(args.plan)
    graph, _ = read_shown(args, args.path, geometry=args.geometry, scene=args.scene)
    structure = recognise_structure(graph)
    names = room_names(structure, graph)
    if args.plan is not None:
        draw_plan(structure, args.plan, names)
    report = {"file": str(args.path), **structure_record(structure, graph, names)}
    print_report(args, report, structure_lines(structure, graph, names))
    return DONE


def _inspect_words(args: argparse.Namespace) -> int:
    """What a model understands of the scene, for ``--words``."""
    from ..generate import Generator
    from ..pretrained import find_generator

    generator = Generator.load(find_generator(args.words))
    graph, _ = read_shown(args, args.path, geometry=args.geometry, scene=args.scene)
    reading = generator.read(graph, words_of(args))
    print_report(args, {"file": str(args.path), **reading.to_record()}, reading.report_lines())
    return DONE


def _inspect_dataset(args: argparse.Namespace) -> int:
    from ..dataset.dataset_description import describe_dataset, description_lines

    record = describe_dataset(args.path)
    if args.figures is not None:
        from ..dataset.dataset_pictures import draw_dataset

        record["figures"] = [str(path) for path in draw_dataset(args.path, args.figures)]
    print(json.dumps(record, ensure_ascii=False) if args.json else "\n".join(description_lines(record)))
    return DONE


def _summary_lines(record: dict[str, Any]) -> list[str]:
    lines = [f"{record['title']}: {record['entities']} entities, {record['roots']} roots, {record['meshes']} meshes"]
    for key in ("types", "categories", "components"):
        if record[key]:
            lines.append(f"{key}: " + ", ".join(f"{name} {count}" for name, count in record[key].items()))
    if "frames" in record:
        text = "frames: {start:g} to {end:g} at {rate:g} a second, now {frame:g}"
        lines.append(text.format_map(record["frames"]))
    return lines

"""What several verbs share: options, reading a scene with a progress bar, and the report at the end."""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import UniSGError
from ..runtime.process_pool import limit_threads, processes
from ..runtime.progress import Progress
from ..runtime.wording import first_lines, some_of
from .argument_types import PATH, whole

if TYPE_CHECKING:
    from ..runtime.read_report import ReadReport
    from ..scene import SceneGraph

MOMENT = 1.0  # seconds
SHOWN = 100
KINDS_OF_LOSS = 20
ENCODERS = {"atlasnet": "unisg_blender.meshes.shape_feature:atlasnet_feature"}
"""Mesh encoders that have a name of their own."""


def add_scene(parser: argparse.ArgumentParser, name: str = "file", meaning: str = "a scene file") -> None:
    """The scene that a verb reads, with what gives it categories."""
    parser.add_argument(name, metavar="FILE", type=PATH, help=meaning)
    add_mapping(parser)


def add_mapping(parser: argparse.ArgumentParser) -> None:
    """What gives categories to objects that have none, and where the meshes of layouts lie."""
    parser.add_argument(
        "--mapping", metavar="FILE", type=PATH, help="JSON or TOML: name patterns to categories, and what words mean"
    )
    parser.add_argument(
        "--assets",
        metavar="FOLDER",
        type=PATH,
        help="meshes, and their sizes, of layouts of other programs (else boxes)",
    )


def words_of(args: argparse.Namespace) -> dict[str, str]:
    """What ``--mapping`` says of words for things, word to category."""
    from ..words import read_mapping

    return {} if args.mapping is None else read_mapping(args.mapping).get("words", {})


def add_scene_options(parser: argparse.ArgumentParser) -> None:
    """What is read of a Blender file."""
    parser.add_argument(
        "--geometry",
        choices=("evaluated", "original", "none"),
        default="evaluated",
        help="of Blender scenes: meshes with modifiers applied (default), as they are edited, or none",
    )
    parser.add_argument("--scene", default="", metavar="NAME", help="of a file with several scenes: this one")


def add_form(parser: argparse._ActionsContainer, default: str = "quaternion") -> None:
    """The form of poses in a dataset."""
    from ..poses import FORMS

    parser.add_argument("--form", choices=FORMS, default=default, help=f"form of the dataset's poses ({default})")


def add_dataset_options(parser: argparse.ArgumentParser) -> None:
    """What is written of meshes and names in a dataset."""
    parser.add_argument(
        "--mesh-features", metavar="ENCODER", default="", help='"atlasnet", or module:function: a vector for each mesh'
    )
    parser.add_argument(
        "--vocabulary", metavar="DATASET", type=PATH, help="number categories, relations and kinds of scene as it does"
    )


def mesh_encoder_of(args: argparse.Namespace) -> str:
    """The function that ``--mesh-features`` names, "package.module:function", "" for none."""
    return ENCODERS.get(args.mesh_features, args.mesh_features)


def vocabulary_of(args: argparse.Namespace) -> dict[str, tuple[str, ...]] | None:
    """The names by number of the dataset that ``--vocabulary`` names."""
    from ..dataset.format.reader import open_dataset

    return None if args.vocabulary is None else open_dataset(args.vocabulary).vocabulary


def add_limit(parser: argparse.ArgumentParser, things: str) -> None:
    """How much a verb prints."""
    parser.add_argument(
        "--limit", type=whole(0, 10**9), default=SHOWN, metavar="N", help=f"show at most N {things} ({SHOWN}; 0: all)"
    )


def jobs_of(args: argparse.Namespace) -> int:
    """Processes for ``--jobs``, by default one per processor; who asks for N gets no more than N threads either."""
    if args.jobs is not None:
        limit_threads(args.jobs)
    return processes(args.jobs)


def make_folder(path: Path) -> None:
    """Make a folder, if it is not there; UniSGError if that cannot be."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UniSGError(f"cannot make the folder {path}: {error.strerror}") from None


@contextmanager
def shown(quiet: bool, unit: str) -> Iterator[Callable[[int, int], None]]:
    """A progress bar on stderr, for work that takes longer than a moment."""
    bars: list[Progress] = []
    begin = time.monotonic()

    def tell(done: int, total: int) -> None:
        """Show a bar as soon as it takes longer than a moment."""
        if not bars and time.monotonic() - begin > MOMENT and done < total:
            bars.append(Progress(total, unit, quiet))
        for bar in bars:
            bar.update(done)

    try:
        yield tell
    finally:
        for bar in bars:
            bar.close()


def read_shown(
    args: argparse.Namespace, path: Path, target: Path | None = None, unit: str = "entities read", **options: Any
) -> tuple[SceneGraph, ReadReport]:
    """The scene of a file and what it could not hold, with a progress bar.

    ``target`` is the file that will be written of it, if any; ``options`` are those of
    :func:`~..formats.scene_files.read_scene_file`. Objects without a category have that of ``--mapping``.
    """
    from ..formats.scene_files import check_kinds, read_scene_file
    from ..words import apply_mapping, read_mapping

    mapping = None if args.mapping is None else read_mapping(args.mapping)
    check_kinds(path, target)
    with shown(args.quiet or args.json, unit) as tell:
        graph, lost = read_scene_file(path, tell, assets=args.assets, **options)
    return graph if mapping is None else apply_mapping(graph, mapping), lost


def noted(records: Iterable[Mapping[str, Any]]) -> list[str]:
    """What is to be said of the rooms of a batch, a line for what is said of several."""
    rooms: dict[str, list[str]] = {}
    for record in records:
        if "note" in record:
            rooms.setdefault(record["note"], []).append(record["source"])
    return [f"{some_of(names)}: {note}" for note, names in rooms.items()]


def print_report(args: argparse.Namespace, report: dict[str, Any], lines: Iterable[str]) -> None:
    """The report as JSON if that is asked for, else its lines, unless nothing is to be said."""
    if args.json:
        print(json.dumps(report, ensure_ascii=False))
    elif not args.quiet:
        for line in lines:
            print(line)


def shown_lines(args: argparse.Namespace, lines: Sequence[str], things: str) -> list[str]:
    """The lines about ``things`` that ``--limit`` lets through, and how many it does not."""
    return first_lines(lines, args.limit, f"more {things} (--limit 0 shows all, --json has them)")


def tell_lost(args: argparse.Namespace, lost: ReadReport) -> None:
    """Say on stderr what could not be represented."""
    if not (args.json or args.quiet):
        for line in first_lines(lost.lines(), KINDS_OF_LOSS, "more kinds of loss (--json has them)"):
            print(f"not represented: {line}", file=sys.stderr)

"""``unisg export``: scene files become a dataset for learning."""

from __future__ import annotations

import argparse
import textwrap
from typing import TYPE_CHECKING, Any

from ..errors import DONE, SOME_FAILED
from .argument_types import PATH, PROCESSES, named, number
from .common import add_dataset_options, add_form, add_mapping, mesh_encoder_of, print_report, vocabulary_of
from .outputs import check_folder

if TYPE_CHECKING:
    from ..runtime.progress import Progress

HELP = "Turn scene files into a dataset for learning."
LONGEST_NOTE = 200

EPILOG = "A file that crashes, hangs or cannot be read costs only itself; the dataset's list of files says why."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What the verb takes."""
    parser.epilog = EPILOG
    parser.add_argument("inputs", metavar="IN", type=named, nargs="+", help="scene files, folders and globs")
    parser.add_argument("--out", metavar="DATASET", type=PATH, required=True, help="folder of the dataset")
    add_form(parser)
    parser.add_argument("--jobs", metavar="N", type=PROCESSES, help="files read at a time (one per processor)")
    parser.add_argument(
        "--timeout", metavar="SECONDS", type=number(0.1, 10**7), default=300.0, help="limit for one file (300)"
    )
    parser.add_argument(
        "--memory", metavar="GIB", type=number(0, 10**6), default=0.0, help="limit for one reading process (none)"
    )
    add_mapping(parser)
    parser.add_argument(
        "--understand",
        action="store_true",
        help="categories for what has none: by the words of its name (in those of --vocabulary), and floors, walls and "
        "ceilings by geometry",
    )
    parser.add_argument(
        "--instances",
        choices=("realize", "keep"),
        default="realize",
        help="what collections, geometry nodes and particles show: objects (realize), or left out (keep)",
    )
    parser.add_argument("--folder-labels", action="store_true", help="a file's folder names its kind of scene")
    add_dataset_options(parser)
    parser.add_argument("--scheduler", metavar="ADDRESS", help="of a Dask scheduler that runs the files")
    again = parser.add_mutually_exclusive_group()
    again.add_argument("--resume", action="store_true", help="go on with an interrupted export, or update a dataset")
    again.add_argument("--overwrite", action="store_true", help="replace the dataset in that folder")


def run(args: argparse.Namespace) -> int:
    """Export, show progress and one line per file that lost something or failed."""
    from ..dataset.export.batch_export import ExportOptions, export_steps
    from ..runtime.job_pool import dask_executor
    from ..runtime.progress import Progress
    from ..runtime.steps import drain
    from ..words import read_mapping

    check_folder("--out", args.out)
    options = ExportOptions(
        form=args.form,
        timeout=args.timeout,
        memory=int(args.memory * 2**30),
        mapping=None if args.mapping is None else read_mapping(args.mapping),
        understand=args.understand,
        instances=args.instances,
        folder_labels=args.folder_labels,
        vocabulary=vocabulary_of(args),
        mesh_encoder=mesh_encoder_of(args),
        assets="" if args.assets is None else str(args.assets.absolute()),
    )
    bar = Progress(0, "files", args.quiet)
    counts = {"done": 0, "failed": 0}

    def show(step: tuple[dict[str, Any] | None, int]) -> None:
        """Show how many files there are, or one that is done."""
        record, files = step
        if record is None:
            bar.start(files)
            return
        counts["done"] += 1
        counts["failed"] += record["status"] == "failed"
        _show_file(bar, record)
        bar.update(counts["done"], counts["failed"])

    with dask_executor(args.scheduler) as executor:
        steps = export_steps(
            args.inputs, args.out, options, executor=executor, jobs=args.jobs, resume=args.resume,
            overwrite=args.overwrite,
        )  # fmt: skip
        try:
            records = drain(steps, show)
        finally:
            bar.close()
    return _report(args, records)


def _show_file(bar: Progress, record: dict[str, Any]) -> None:
    """One line about a file: why it failed, or what of it is not in the dataset."""
    from ..dataset.dataset_description import printable

    source = printable(record["source"])
    if record["status"] == "failed":
        bar.write(f"{source}: FAILED: {record['reason']}")
    elif record["status"] == "ok":
        note = textwrap.shorten(
            record["not_represented"], LONGEST_NOTE, placeholder=" ... (all of it in files-*.jsonl)"
        )
        bar.write(f"{source}: {f'not represented: {note}' if note else 'complete'}")


def _report(args: argparse.Namespace, records: list[dict[str, Any]]) -> int:
    from ..dataset.dataset_description import source_line
    from ..dataset.format.source_counts import source_counts
    from ..formats.licences import forbids_shipping

    failed = [record for record in records if record["status"] == "failed"]
    scenes = sum(record.get("scenes", 0) for record in records)
    entities = sum(record.get("entities", 0) for record in records)
    report = {"out": str(args.out), "files": len(records), "failed": len(failed), "scenes": scenes}
    words = f", {len(failed)} could not be read" if failed else ""
    line = f"{args.out}: {scenes} scenes with {entities} entities from {len(records)} files{words}"
    sources = source_counts(records)
    told = [source_line(entry) for entry in sources if entry["format"] or forbids_shipping(entry["licence"])]
    print_report(args, report | {"entities": entities, "sources": sources, "records": records}, [line, *told])
    return SOME_FAILED if failed else DONE

"""The command line: one verb per job, each in its own module of ``commands``.

A verb's module has ``HELP`` (one line), ``add_arguments(parser)`` and
``run(args) -> int``; it is imported only when its verb is called or its help
is asked for, so that ``unisg --help`` stays fast.
"""

from __future__ import annotations

import importlib
import os
import sys
from argparse import RawDescriptionHelpFormatter
from collections.abc import Sequence
from typing import NoReturn

from . import __version__
from .errors import UNUSABLE_INPUT, UniSGError, one_line, system_reason
from .runtime.guarded_work import run_guarded
from .runtime.helpful_parser import HelpfulParser
from .runtime.process_end import end_process, stop_when_asked

VERBS = {
    "inspect": "show the entity tree of a scene, or the contents of a dataset",
    "world": "make procedural scenes",
    "convert": "turn a scene file into a Blender, USD, glTF or JSON file, through the scenegraph",
    "export": "turn scene files into a dataset for learning",
    "train": "train a model on a dataset",
    "evaluate": "measure what a model makes, beside baselines and real scenes",
    "generate": "add objects to an empty or an existing scene with a trained model",
    "render": "pictures of scenes with labels: masks, depth, boxes, COCO files, scenegraphs of what is seen",
    "relations": "tell which thing stands on, in or beside which",
    "classify": "tell what kind of scene a file holds",
    "label": "propose categories for objects that have none",
    "simulate": "play a scene's lesson against its animation, a recording, a script or a rehearsal",
    "web": "make a page in which a browser plays a scene's lesson",
    "benchmark": "measure and write tables and figures",
    "demo": "run the main job end to end on shipped content",
}


def _overview() -> HelpfulParser:
    lines = "\n".join(f"  {verb:<12}{text}" for verb, text in VERBS.items())
    parser = HelpfulParser(
        prog="unisg",
        description="Scenegraphs that join geometry, behaviour and graph learning.",
        epilog=f"verbs:\n{lines}\n\n'unisg VERB --help' tells more about one.",
        formatter_class=RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"unisg {__version__}")
    parser.add_argument("verb", metavar="VERB", choices=VERBS, help="what to do")
    return parser


def _verb_parser(verb: str) -> tuple[HelpfulParser, object]:
    module = importlib.import_module(f"{__package__}.commands.{verb}")
    parser = HelpfulParser(prog=f"unisg {verb}", description=module.HELP)
    module.add_arguments(parser)
    parser.add_argument("--json", action="store_true", help="write a machine-readable report to stdout")
    parser.add_argument("-q", "--quiet", action="store_true", help="print no progress and no summary")
    return parser, module


def main(argv: Sequence[str] | None = None) -> int:
    """Run one verb.

    Parameters
    ----------
    argv
        The words after the program's name; ``sys.argv[1:]`` when omitted. None at all, or "help", asks for help.

    Returns
    -------
    int
        Exit status: 0 done, 1 unusable input (one line on stderr, nothing
        written), 2 misuse, 3 a batch in which some items failed.
    """
    words = list(sys.argv[1:] if argv is None else argv) or ["help"]
    if words[0] == "help":
        words = [*words[1:2], "--help"]
    try:
        _overview().parse_args(words[:1])
        parser, module = _verb_parser(words[0])
        args = parser.parse_args(words[1:])
    except SystemExit as stop:  # --help and --version stop with 0
        return int(stop.code or 0)
    try:
        return int(module.run(args))  # type: ignore[attr-defined]
    except UniSGError as error:
        print(f"unisg {words[0]}: {one_line(error)}", file=sys.stderr)
        return UNUSABLE_INPUT
    except BrokenPipeError:  # the reader of our output (head, less) has gone: that is its right
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        print(f"unisg {words[0]}: {system_reason(error)}", file=sys.stderr)
        return UNUSABLE_INPUT
    except KeyboardInterrupt:
        print(f"unisg {words[0]}: stopped", file=sys.stderr)
        return 130


def program() -> NoReturn:
    """Run the verb that the words after the program's name ask for, guarded, and end the process."""
    run_guarded(_work, " ".join(["unisg", *sys.argv[1:2]]))


def _work() -> NoReturn:
    stop_when_asked()
    end_process(main())

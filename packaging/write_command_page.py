"""Write docs/commands.md: every verb of the command line with its options, as its parser has them.

python packaging/write_command_page.py
"""

from __future__ import annotations

import argparse
import re

from architecture import ROOT

from unisg_blender import cli

PAGE = ROOT / "docs" / "commands.md"
HEAD = """# The command line

Three doors, one house: `unisg VERB`, `python -m unisg_blender VERB`, `blender --command unisg VERB`. Every verb has
`--help`, `--json` (a report for programs, on stdout) and `-q`. `make docs` writes this page from the parsers.

```
unisg world operating-room --count 100 --out rooms/          # procedural scenes: .blend, USD, JSON or a dataset
unisg inspect FILE                                           # entity tree, categories, behaviour, relations
unisg inspect FILE --structure --plan plan.svg               # floors, rooms, walls, doors and surfaces, by geometry
unisg inspect FILE --words living_room                       # what a model understands of its names: Couch -> Sofa
unisg export scenes/ --out dataset --form dual_quaternion    # any folder of .blend, glTF, USD, FBX, OBJ, or of layouts:
unisg convert train.jsonl.gz house.blend --scene 17          # ProcTHOR, Habitat, 3D-FRONT, Gazebo ...: docs/formats.md
unisg train cgvae --data dataset --out room.onnx             # your own generator
unisg generate --model room.onnx --add "Scalpel=2,Monitor=1" --scene room.blend --out fuller.blend
unisg generate --add "Clamp=3" --beside Scalpel --scene room.blend --out fuller.blend   # or --on "Mayo Stand"
unisg generate --add "Chair=2" --in kitchen --model living_room --scene house.blend --out more.blend
unisg generate --scene scenes/ --count 100 --out rooms/ --jobs 8   # a hundred of each, resumable, on a cluster too
unisg render rooms/ --out pictures/ --views eye=4   # pictures, masks, COCO labels, scenegraphs of what is seen
unisg simulate room.blend --rehearse --record played.usdc    # plays the lesson: which action was done when, and why
unisg convert room.blend room.usda                           # one master file: geometry, hierarchy, behaviour
unisg convert room.blend room.glb                            # for every viewer, the lesson as KHR_interactivity
unisg web room.blend --out site/ --serve                     # the lesson as a page: docs/interactivity.md
```

Exit status: 0 done; 1 an input that cannot be used (one line says why, nothing is written); 2 misuse; 3 a batch in
which some items failed.
"""
EVERYWHERE = {"help", "json", "quiet"}


def page() -> str:
    """The whole page."""
    return "\n".join([HEAD, *(_verb(verb) for verb in cli.VERBS)])


def _verb(verb: str) -> str:
    parser, _ = cli._verb_parser(verb)
    usage = " ".join(parser.format_usage().split()).removeprefix("usage: ")
    usage = re.sub(r"\s*\[--json\] \[-q\]|\s*\[-h\]", "", usage)
    lines = [_argument(each) for each in parser._actions if each.dest not in EVERYWHERE]
    return f"## {verb}\n\n{parser.description}\n\n```text\n{_folded(usage)}\n```\n\n" + "\n".join(lines) + "\n"


def _folded(usage: str, width: int = 100) -> str:
    """A line of usage, broken between its options."""
    lines = [""]
    for part in re.findall(r"\[[^\[\]]*(?:\[[^\]]*\][^\[\]]*)*\]|\S+", usage):
        if lines[-1] and len(lines[-1]) + len(part) > width:
            lines.append("   ")
        lines[-1] += f" {part}" if lines[-1] else part
    return "\n".join(lines)


def _argument(action: argparse.Action) -> str:
    """One option or positional argument as an item of a list."""
    value = "" if action.nargs == 0 else _value(action)
    names = ", ".join(f"{name} {value}".strip() for name in action.option_strings) or value
    text = (action.help or "") % vars(action) if "%(" in (action.help or "") else (action.help or "").replace("%%", "%")
    return f"- `{names}`: {re.sub(r'<(?=[a-zA-Z])', '&lt;', text)}"


def _value(action: argparse.Action) -> str:
    """What is put behind an option."""
    if isinstance(action.metavar, tuple):
        return " ".join(action.metavar)
    if action.metavar:
        return action.metavar
    return "{" + ",".join(map(str, action.choices)) + "}" if action.choices else action.dest.upper()


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")

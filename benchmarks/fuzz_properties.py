"""Hostile properties for :mod:`.fuzz`: every operator with values that nobody means, in a scene with a lesson."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from tests.extension_package import load_extension
from unisg_blender.blender.blend_files import write_blend
from unisg_blender.errors import UniSGError
from unisg_blender.runtime.output_capture import captured_output
from unisg_blender.worlds import living_room

Case = Callable[[], object]
Random = np.random.Generator

FLOATS = (0.0, -0.0, -1.0, 1e-38, 1e38, -1e38, float("inf"), float("-inf"), float("nan"))
WHOLE = (0, -1, 1, 2**31 - 1, -(2**31))
TEXTS = (
    "", " ", "x", "x" * 300, "x" * 100_000, "a\nb", "ä🦊", "\udcff", "nan", "-1", "{}", "[" * 2000, '{"unisg": 1}',
    "Cup=1", "Cup=-1", "Cup=nan", "Cup=1000000000", "Cup=1,Cup=2", "=1", "Cup", "Cup.001", "/", "//", "//x.usdc",
    "//none/x.usdc", "x.usdc", "x.json", "room.blend", "x.onnx", ".", "../none", "/dev/null", "%s%n", "motor", "on",
)  # fmt: skip
MODES = ("OBJECT", "OBJECT", "OBJECT", "EDIT")


def prepare(folder: Path) -> Callable[[Random], Case]:
    """Every operator, with one to three of its own properties and of the sidebar's settings changed."""
    package = load_extension()
    if not hasattr(bpy.types, "UNISG_OT_generate"):
        package.register()
    room = folder / "room.blend"
    write_blend(living_room(0), room)
    (folder / "x.json").write_text("{}")
    names = sorted(dir(bpy.ops.unisg))

    def make(rng: Random) -> Case:
        name = names[rng.integers(len(names))]
        operator = getattr(bpy.ops.unisg, name)
        own = [each for each in operator.get_rna_type().properties if each.identifier != "rna_type"]
        chosen = [own[place] for place in rng.permutation(len(own))[: rng.integers(1, 4)]]
        values = {each.identifier: hostile(each, rng) for each in chosen}
        settings = [(int(rng.integers(2**31)), rng.spawn(1)[0]) for _ in range(rng.integers(3))]
        active, mode = int(rng.integers(-1, 66)), MODES[rng.integers(len(MODES))]

        def case() -> None:
            with _within(folder), captured_output():
                bpy.ops.wm.open_mainfile(filepath=str(room), use_scripts=False, load_ui=False)
                _choose(active, mode)
                for place, other in settings:
                    _set_one(place, other)
                _call(operator, values)

        return case

    return make


def hostile(prop: bpy.types.Property, rng: Random) -> Any:
    """A value of the type that a property has, which nobody means."""
    if prop.type == "FLOAT":
        bounds = (prop.hard_min, prop.hard_max)
        return float((*FLOATS, *bounds)[rng.integers(len(FLOATS) + 2)])
    if prop.type == "INT":
        return int((*WHOLE, prop.hard_min, prop.hard_max)[rng.integers(len(WHOLE) + 2)])
    if prop.type == "BOOLEAN":
        return bool(rng.integers(2))
    if prop.type == "ENUM" and len(prop.enum_items) and rng.random() < 0.9:
        return prop.enum_items[int(rng.integers(len(prop.enum_items)))].identifier
    return TEXTS[rng.integers(len(TEXTS))]


def _call(operator: Any, values: dict[str, Any]) -> None:
    """Press the button; what it reports, and what Blender says of a value that it does not take, is a refusal."""
    try:
        operator("EXEC_DEFAULT", **values)
    except (RuntimeError, TypeError, UnicodeEncodeError) as error:
        text = str(error).strip()
        if "Traceback" in text:
            lines = [line.strip() for line in text.splitlines() if line.strip() and not line.startswith("Location")]
            raise AssertionError(f"{lines[-1]}, after {lines[-3] if len(lines) > 2 else ''}") from None
        raise UniSGError(text[:1000] or "refused") from None


def _choose(active: int, mode: str) -> None:
    """Make an object active and selected, none for -1, in a mode that it may have."""
    items = bpy.context.view_layer.objects
    items.active = None if active < 0 else items[active % len(items)]
    if items.active is not None:
        items.active.select_set(True)
        with contextlib.suppress(RuntimeError):
            bpy.ops.object.mode_set(mode=mode)


def _set_one(place: int, rng: Random) -> None:
    """Change one setting of the sidebar."""
    manager = bpy.context.window_manager
    groups = [getattr(manager, key) for key in dir(type(manager)) if key.startswith("unisg")]
    groups = [group for group in groups if isinstance(group, bpy.types.PropertyGroup)]
    found = [
        (group, prop)
        for group in groups
        for prop in group.bl_rna.properties
        if not prop.is_readonly and prop.identifier not in ("rna_type", "name")
    ]
    group, prop = found[place % len(found)]
    with contextlib.suppress(TypeError, UnicodeEncodeError):  # Blender does not take it
        setattr(group, prop.identifier, hostile(prop, rng))


@contextlib.contextmanager
def _within(folder: Path) -> Iterator[None]:
    before = Path.cwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)

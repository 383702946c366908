"""Opening a stage, and the turn from its units and upward axis to metres and Z up."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pxr import Sdf, Tf, Usd, UsdGeom, UsdUtils

from ...errors import UniSGError
from .stage_frames import mend_rates
from .unfolded_size import check_size

DEEPEST = 500
"""Nesting that is still read; USD's text reader recurses and would end the whole process far beyond."""
UNITS = (1e-15, 1e18)
"""The smallest and the largest scene unit in metres: from less than a nanometre to more than a light year."""
Y_TO_Z = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])


def open_stage(path: Path) -> Any:
    """The composed stage of a file.

    Raises
    ------
    UniSGError
        If USD cannot read the file.
    """
    _check_nesting(path)
    try:
        with quiet() as messages:
            known = Sdf.Layer.Find(str(path))
            if known is not None:
                known.Reload()
            layer = known or Sdf.Layer.FindOrOpen(str(path))
            if layer is not None:
                check_size(layer, path)
            stage = Usd.Stage.Open(str(path) if layer is None else layer)
    except Tf.ErrorException as error:
        raise UniSGError(f"{path}: not a readable USD file: {_first_reason(error)}") from None
    if stage is None:
        raise UniSGError(f"{path}: not a readable USD file")
    for text in dict.fromkeys(messages):
        warnings.warn(f"{path.name}: {text}", stacklevel=4)
    mend_rates(stage)
    return stage


def layer_files(path: Path) -> list[Path]:
    """All layers that a USD file refers to, through other layers, too; what lies inside a package is part of it."""
    found: dict[str, None] = {}
    waiting = [str(path.absolute())]
    while waiting:
        try:
            with quiet():
                layer = Sdf.Layer.FindOrOpen(waiting.pop())
        except Tf.ErrorException:  # damaged: reading has told so
            continue
        for name in filter(None, layer.GetCompositionAssetDependencies() if layer else ()):
            if (file := layer.ComputeAbsolutePath(name)) not in found:
                found[file] = None
                waiting.append(file)
    return [Path(name) for name in found if "[" not in name]


@contextmanager
def quiet() -> Iterator[list[str]]:
    """Collect USD's diagnostics in a list instead of printing them."""
    messages: list[str] = []
    delegate = UsdUtils.CoalescingDiagnosticDelegate()
    try:
        yield messages
    finally:
        messages += [" ".join(item.commentary.split()) for item in delegate.TakeUncoalescedDiagnostics()]
        del delegate


def _first_reason(error: Exception) -> str:
    try:
        lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    except UnicodeDecodeError:  # USD quotes bytes of the damaged file
        lines = ["it holds bytes that are no text"]
    reason = lines[0] if lines else "unknown error"
    return reason.split(" : ", 1)[-1].strip("'")[:300]


def _check_nesting(path: Path) -> None:
    """Refuse text files whose braces nest too deeply (those within strings and comments count too)."""
    with path.open("rb") as file:
        if not file.read(16).lstrip().startswith(b"#usda"):
            return
        file.seek(0)
        depth = deepest = 0
        while chunk := file.read(1 << 22):
            array = np.frombuffer(chunk, np.uint8)
            opening = np.isin(array, np.frombuffer(b"{([", np.uint8)).astype(np.int32)
            steps = opening - np.isin(array, np.frombuffer(b"})]", np.uint8))
            level = depth + np.cumsum(steps)
            deepest, depth = max(deepest, int(level.max())), int(level[-1])
    if deepest > DEEPEST:
        raise UniSGError(f"{path}: braces nest {deepest} deep, more than the {DEEPEST} that can be read")


def stage_frame(stage: Any) -> NDArray[np.float64]:
    """4x4 matrix from the stage's frame to metres and Z up; the identity where the stage is so already."""
    scale = float(UsdGeom.GetStageMetersPerUnit(stage))
    if not UNITS[0] <= scale <= UNITS[1]:
        warnings.warn(f"a unit of {scale:g} metres cannot be; read as 1 metre", stacklevel=2)
        scale = 1.0
    turn = Y_TO_Z if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.y else np.eye(4)
    return turn @ np.diag([scale, scale, scale, 1.0])

"""Opening a stage, and the turn from its units and upward axis to metres and Z up."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pxr import Tf, Usd, UsdGeom

from ...errors import UniSGError
from .layer_files import open_layers, plain, quiet
from .skinning import pose_skinned
from .stage_frames import mend_rates
from .unfolded_size import check_size

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
    layers = open_layers(path)  # kept until the stage has them
    layer = layers[str(path.absolute())]
    try:
        with quiet() as messages:
            if layer is not None:
                check_size(layer, path)
            stage = Usd.Stage.Open(str(path) if layer is None else layer)
    except Tf.ErrorException as error:
        raise UniSGError(f"{path}: not a readable USD file: {first_reason(error)}") from None
    if stage is None:
        raise UniSGError(f"{path}: not a readable USD file")
    for text in dict.fromkeys(messages):
        warnings.warn(f"{path.name}: {text}", stacklevel=4)
    mend_rates(stage)
    pose_skinned(stage)
    return stage


def first_reason(error: Exception) -> str:
    """What USD says first of what went wrong."""
    try:
        lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    except UnicodeDecodeError:  # USD quotes bytes of the damaged file
        lines = ["it holds bytes that are no text"]
    reason = lines[0] if lines else "unknown error"
    return plain(reason.split(" : ", 1)[-1])


def stage_frame(stage: Any) -> NDArray[np.float64]:
    """4x4 matrix from the stage's frame to metres and Z up; the identity where the stage is so already."""
    scale = float(UsdGeom.GetStageMetersPerUnit(stage))
    if not UNITS[0] <= scale <= UNITS[1]:
        warnings.warn(f"a unit of {scale:g} metres cannot be; read as 1 metre", stacklevel=2)
        scale = 1.0
    turn = Y_TO_Z if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.y else np.eye(4)
    return turn @ np.diag([scale, scale, scale, 1.0])

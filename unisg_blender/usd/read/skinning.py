"""Skinned meshes as their skeletons pose them."""

from __future__ import annotations

import warnings
from typing import Any

from pxr import Gf, Tf, Usd, UsdSkel


def pose_skinned(stage: Any) -> None:
    """Let skinned meshes have the points of their pose at the stage's first frame; the files stay as they are.

    Meshes inside native instances stay as they are modelled.
    """
    moment = stage.GetStartTimeCode() if stage.HasAuthoredTimeCodeRange() else 0.0
    session = stage.GetSessionLayer()
    stage.SetEditTarget(session)
    try:
        UsdSkel.BakeSkinning(Usd.PrimRange(stage.GetPseudoRoot()), Gf.Interval(moment, moment))
    except Tf.ErrorException:
        warnings.warn("its skinned meshes cannot be posed; read as they are modelled", stacklevel=2)
    posed: list[Any] = []
    session.Traverse("/", lambda path: posed.append(path) if session.GetNumTimeSamplesForPath(path) else None)
    for path in posed:
        session.GetAttributeAtPath(path).default = session.QueryTimeSample(path, moment)
        session.EraseTimeSample(path, moment)

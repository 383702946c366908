"""Skinned meshes as their skeletons pose them."""

from __future__ import annotations

import warnings
from typing import Any

from pxr import Gf, Tf, Usd, UsdSkel

from .layer_files import quiet

INDICES = "primvars:skel:jointIndices"
MOST_COPIES = 1000
"""Native instances with skinned meshes that are posed."""


def pose_skinned(stage: Any) -> None:
    """Let skinned meshes have the points of their pose at the stage's first frame; the files stay as they are.

    Native instances with skinned meshes are read as copies of their own: what is shared cannot be posed.
    """
    moment = stage.GetStartTimeCode() if stage.HasAuthoredTimeCodeRange() else 0.0
    session = stage.GetSessionLayer()
    stage.SetEditTarget(session)
    _part_skinned_instances(stage)
    _sample_at(stage, moment)
    try:
        with quiet():
            UsdSkel.BakeSkinning(Usd.PrimRange(stage.GetPseudoRoot()), Gf.Interval(moment, moment))
    except Tf.ErrorException:
        warnings.warn("its skinned meshes cannot be posed; read as they are modelled", stacklevel=2)
    posed: list[Any] = []
    session.Traverse("/", lambda path: posed.append(path) if session.GetNumTimeSamplesForPath(path) else None)
    for path in posed:
        session.GetAttributeAtPath(path).default = session.QueryTimeSample(path, moment)
        session.EraseTimeSample(path, moment)


def _part_skinned_instances(stage: Any) -> None:
    """Let native instances with skinned meshes be no instances, from the outermost inwards."""
    while True:
        skinned = [
            instance
            for prototype in stage.GetPrototypes()
            if any(prim.HasAttribute(INDICES) for prim in Usd.PrimRange(prototype, Usd.TraverseInstanceProxies()))
            for instance in prototype.GetInstances()
            if not instance.IsInPrototype()
        ]
        if not skinned:
            return
        if len(skinned) > MOST_COPIES:
            warnings.warn(f"{len(skinned)} instances of skinned meshes are read as they are modelled", stacklevel=3)
            return
        for path in [instance.GetPath() for instance in skinned]:
            stage.GetPrimAtPath(path).SetInstanceable(False)


def _sample_at(stage: Any, moment: float) -> None:
    """Give the skeletons' animations samples at a moment: baking passes over all others, and what they hold between."""
    for prim in stage.Traverse():
        if prim.IsA(UsdSkel.Animation):
            for attribute in prim.GetAttributes():
                if attribute.GetNumTimeSamples():
                    attribute.Set(attribute.Get(moment), moment)

"""Mesh features as strings, to be kept in custom properties."""

from __future__ import annotations

import base64
import binascii
import json

import numpy as np

from ..errors import UniSGError
from .atlasnet_sessions import FEATURE_WIDTH
from .normalise import UnitPlacement
from .shape_feature import MeshFeature

PROPERTY = "unisg_mesh_feature"
"""Custom property of mesh data that holds a feature."""

VERSION = 1


def feature_to_text(feature: MeshFeature) -> str:
    """JSON with the vector as base64 of little-endian float32."""
    vector = base64.b64encode(feature.vector.astype("<f4").tobytes()).decode("ascii")
    center, scale = feature.placement.center.tolist(), feature.placement.scale
    return json.dumps({"version": VERSION, "center": center, "scale": scale, "vector": vector})


def feature_from_text(text: str) -> MeshFeature:
    """The feature that :func:`feature_to_text` wrote.

    Raises
    ------
    UniSGError
        If the text is damaged or of another version.
    """
    try:
        record = json.loads(text)
        version = record["version"]
        vector = np.frombuffer(base64.b64decode(record["vector"], validate=True), "<f4").astype(np.float32)
        placement = UnitPlacement(np.array(record["center"], np.float64), float(record["scale"]))
    except (ValueError, TypeError, KeyError, binascii.Error):
        raise UniSGError("the stored mesh feature is damaged: encode the mesh again") from None
    if version != VERSION or vector.shape != (FEATURE_WIDTH,) or placement.center.shape != (3,):
        raise UniSGError(f"the stored mesh feature is of version {version}: encode the mesh again")
    if not (np.isfinite(vector).all() and np.isfinite(placement.center).all() and placement.scale > 0):
        raise UniSGError("the stored mesh feature is damaged: encode the mesh again")
    return MeshFeature(vector, placement)

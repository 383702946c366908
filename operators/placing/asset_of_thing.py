"""The asset that is placed by pointing: a collection, one of a library, or the shapes that a category has."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

from ..shapes.given_shapes import MOST, opened_asset
from ..shapes.shape_sources import source_of

if TYPE_CHECKING:
    from ...unisg_blender.dataset.assets.asset import Asset


def asset_and_shapes(
    scene: bpy.types.Scene, asked: bpy.types.OperatorProperties
) -> tuple[Asset | None, tuple[Asset, ...]]:
    """What the operator's ``collection`` or ``asset`` is, and else the shapes that its ``category`` begins with.

    Raises
    ------
    UniSGError
        If it is missing, or shows nothing.
    """
    from ...unisg_blender.blender.assets.shape_data import COLLECTION, ShapeData, from_text

    if asked.collection or asked.asset:
        shape = from_text(asked.asset) if asked.asset else ShapeData(COLLECTION, asked.collection)
        return opened_asset(scene, asked.category, shape), ()
    shapes = () if asked.source else source_of(scene, asked.category).shapes[:MOST]
    return None, tuple(opened_asset(scene, asked.category, shape) for shape in shapes)

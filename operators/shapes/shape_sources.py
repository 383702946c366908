"""Where the shapes of a category come from: the first of five places that has any."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import bpy

from ...unisg_blender.blender.assets.asset_catalogs import catalogs_for, words_of
from ...unisg_blender.blender.assets.asset_script import asset_record
from ...unisg_blender.blender.assets.shape_data import COLLECTION, COLUMN, HOLDER, OBJECT, ShapeData
from ..scene_lookup import looked_up
from .library_index import LibraryAsset, known_assets

if TYPE_CHECKING:
    from ...unisg_blender.words import VocabularyMatch

CHOSEN, FILE, LIBRARY, SCENE, MODEL = "CHOSEN", "FILE", "LIBRARY", "SCENE", "MODEL"


@dataclass(frozen=True)
class ShapeSource:
    """Where shapes come from, in words; ``shapes`` are those that are not the generator's own matter."""

    kind: str
    text: str
    shapes: tuple[ShapeData, ...] = ()


def source_of(scene: bpy.types.Scene, category: str, marked: list[LibraryAsset] | None = None) -> ShapeSource:
    """Where the shapes of a category come from in a scene; ``marked`` is :func:`file_assets` for who has it."""
    if chosen := chosen_shape(scene, category):
        return ShapeSource(CHOSEN, f"{chosen.name}, chosen", (chosen,))
    if here := [asset for asset in (file_assets() if marked is None else marked) if means(asset.words, category)]:
        return ShapeSource(FILE, _counted(here, "this file"), tuple(asset.shape for asset in here))
    found = [asset for asset in known_assets() if means(asset.words, category)]
    if found:
        names = " and ".join(dict.fromkeys(asset.library for asset in found))
        return ShapeSource(LIBRARY, _counted(found, names), tuple(asset.shape for asset in found))
    if category in looked_up(scene).categories:
        return ShapeSource(SCENE, "those of the scene")
    return ShapeSource(MODEL, "the model's own")


def chosen_shape(scene: bpy.types.Scene, category: str) -> ShapeData | None:
    """What a user chose for a category, None for nothing."""
    item = scene.unisg_shapes.get(category)
    found = None if item is None else item.collection or item.object
    if found is None:
        return None
    kind = COLLECTION if isinstance(found, bpy.types.Collection) else OBJECT
    return ShapeData(kind, found.name, bpy.path.abspath(found.library.filepath) if found.library else "")


def file_assets() -> list[LibraryAsset]:
    """The objects and collections of this file that are marked as assets."""
    items = [item for column in COLUMN.values() for item in getattr(bpy.data, column) if item.asset_data is not None]
    records = [asset_record(item) for item in items if item.library is None and HOLDER not in item]
    catalogs = catalogs_for(Path(bpy.data.filepath)) if records and bpy.data.filepath else {}
    return [
        LibraryAsset("", ShapeData(str(record["kind"]), str(record["name"])), tuple(words_of(record, catalogs)))
        for record in records
    ]


@lru_cache(maxsize=4096)
def means(words: tuple[str, ...], category: str) -> bool:
    """Whether one of some words is another one for a category, or the same."""
    from ...unisg_blender.words.vocabulary_match import MAPPED, SAME, WORD

    matcher = _matcher(category)
    return any(matcher.match(word).how in (SAME, WORD, MAPPED) for word in words)


@lru_cache(maxsize=256)
def _matcher(category: str) -> VocabularyMatch:
    from ...unisg_blender.words import VocabularyMatch

    return VocabularyMatch([category])


def _counted(assets: list[LibraryAsset], where: str) -> str:
    return f"{assets[0].shape.name} of {where}" if len(assets) == 1 else f"{len(assets)} assets of {where}"

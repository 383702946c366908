"""Blender's ID custom properties as plain JSON-ready values, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import bpy

from ..errors import UniSGError

LARGEST_INT = 2**31 - 1
OWN = "unisg_"


def custom_properties(owner: bpy.types.ID) -> dict[str, Any]:
    """The custom properties of an object (or any other ID), as JSON-ready values.

    Arrays become lists, groups dictionaries, references to other IDs
    ``{"id": type, "name": name}``. Values that have no such form are left out.
    """
    values = {}
    for key in property_names(owner):
        value = _plain(owner[key])
        if value is not None and key != "_RNA_UI":
            values[key] = value
    return values


def property_names(owner: bpy.types.bpy_struct) -> list[str]:
    """Names of custom properties; what add-ons keep beside them, in the same place before Blender 5.0, left out."""
    return [key for key in owner.keys() if not _of_addon(owner, key)]  # noqa: SIM118  an ID is no mapping


def addon_settings(owner: bpy.types.ID) -> list[str]:
    """Names of other add-ons' settings that a data-block carries. Asking for those themselves would make them."""
    if hasattr(owner, "bl_system_properties_get"):
        stored = owner.bl_system_properties_get()
        found = [] if stored is None else stored.items()
    else:
        found = [(key, value) for key, value in owner.items() if _of_addon(owner, key)]
    return [key for key, value in found if _is_set(value) and not key.startswith(OWN) and not _moved(owner, value)]


def _of_addon(owner: bpy.types.bpy_struct, key: str) -> bool:
    if not hasattr(type(owner), key):  # registered properties are attributes of the class, which is quick to ask
        return False
    found = owner.bl_rna.properties.get(key)
    return found is not None and found.is_runtime


def _is_set(value: Any) -> bool:
    return len(value) > 0 if hasattr(value, "__len__") else True


def _moved(owner: bpy.types.ID, value: Any) -> bool:
    """Whether Blender has all of these settings itself by now, as with Cycles' cameras: what is left is of no use."""
    return hasattr(value, "keys") and all(key in owner.bl_rna.properties for key in value.keys())  # noqa: SIM118


def _plain(value: Any) -> Any:
    if isinstance(value, bool | int | float):
        return value
    if isinstance(value, str):
        return _checked(value)
    if isinstance(value, bytes):
        return value.decode("utf-8", "backslashreplace")
    if isinstance(value, bpy.types.ID):
        return {"id": value.id_type, "name": value.name}
    if hasattr(value, "to_dict"):  # an ID property group
        return {key: plain for key in value.keys() if (plain := _plain(value[key])) is not None}  # noqa: SIM118
    if hasattr(value, "to_list"):  # an ID property array
        return value.to_list()
    if isinstance(value, list | tuple):
        return [plain for item in value if (plain := _plain(item)) is not None]
    return None


def _checked(text: str) -> str:
    """The text, if it is one: of a damaged file Blender makes texts with characters that cannot be."""
    try:
        if not text.isascii():
            text.encode("utf-8", "surrogatepass")
    except ValueError:
        raise UniSGError("a custom property is damaged: it holds what is no text") from None
    return text


def set_custom_properties(owner: bpy.types.ID, values: Mapping[str, Any]) -> list[str]:
    """Set custom properties from JSON values; returns the names that Blender refused."""
    refused = []
    for key, value in values.items():
        try:
            owner[key] = _settable(value)
        except (TypeError, ValueError, OverflowError, KeyError, RuntimeError):
            refused.append(key)
    return refused


def _settable(value: Any) -> Any:
    if isinstance(value, Mapping):
        if set(value) == {"id", "name"}:
            found = _find_id(str(value["id"]), str(value["name"]))
            return found if found is not None else dict(value)
        return {str(key): _settable(item) for key, item in value.items()}
    if isinstance(value, int) and not isinstance(value, bool) and abs(value) > LARGEST_INT:
        return str(value)  # Blender's integers have 32 bits
    return value


def _find_id(kind: str, name: str) -> bpy.types.ID | None:
    for collection in (bpy.data.objects, bpy.data.collections, bpy.data.materials, bpy.data.meshes, bpy.data.images):
        found = collection.get(name)
        if found is not None and found.id_type == kind:
            return found
    return None

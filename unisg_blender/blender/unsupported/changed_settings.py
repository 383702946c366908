"""Which settings of Blender's data stand at another value than Blender's own default."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from functools import cache
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

NUMBERS = {"BOOLEAN": np.bool_, "INT": np.int32, "FLOAT": np.float32, "ENUM": np.int32}
NO_SETTINGS = frozenset(
    {
        "rna_type",
        "name",
        "tag",
        "use_fake_user",
        "use_extra_user",
        "is_runtime_data",
        "use_nodes",
        "use_new_cpu_compositor",
    }
)
SAME = 1e-5
NEW: dict[str, dict[str, Any]] = {
    "Object": {
        "use_grease_pencil_lights": False, "show_empty_image_perspective": True, "show_empty_image_orthographic": True,
        "visible_diffuse": True, "visible_glossy": True, "visible_transmission": True, "visible_volume_scatter": True,
        "visible_shadow": True,
    },
    "Armature": {"show_bone_custom_shapes": True},
    "Bone": {
        "display_type": "ARMATURE_DEFINED", "use_inherit_rotation": True, "use_local_location": True,
        "use_cyclic_offset": True, "envelope_distance": 0.25, "envelope_weight": 1.0, "head_radius": 0.1,
        "tail_radius": 0.05, "bbone_segments": 1, "bbone_x": 0.1, "bbone_z": 0.1,
    },
    "PoseBone": {
        "ik_min_x": -np.pi, "ik_max_x": np.pi, "ik_min_y": -np.pi, "ik_max_y": np.pi, "ik_min_z": -np.pi,
        "ik_max_z": np.pi, "use_custom_shape_bone_size": True, "custom_shape_wire_width": 1.0,
        "lock_rotations_4d": True,
    },
    "Collection": {"color_tag": "NONE"},
    "Material": {
        "blend_method": "HASHED", "use_transparency_overlap": True, "show_transparent_back": True,
        "use_backface_culling_lightprobe_volume": True,
    },
    "Scene": {
        "sync_mode": "NONE", "use_audio": True, "audio_distance_model": "INVERSE_CLAMPED",
        "show_keys_from_selected_only": True,
    },
    "RenderSettings": {
        "use_overwrite": True, "use_stamp_labels": True, "simplify_gpencil_antialiasing": True,
        "simplify_gpencil_view_fill": True, "simplify_gpencil_modifier": True, "simplify_gpencil_shader_fx": True,
        "simplify_gpencil_tint": True, "use_stamp_memory": False,
        "simplify_subdivision_render": 6, "simplify_child_particles_render": 1.0,
    },
    "ColorManagedViewSettings": {"look": "None", "view_transform": "AgX"},
}  # fmt: skip
"""What a new file has where Blender (in all or some versions) names another default."""

STARTUP: dict[str, dict[str, Any]] = {
    "Object": {"color": (0.0, 0.0, 0.0, 0.0)},
    "Material": {
        "alpha_threshold": 0.0, "line_color": (0.0, 0.0, 0.0, 1.0), "use_backface_culling_lightprobe_volume": False,
    },
}  # fmt: skip
"""What the things of Blender's own startup file have instead: nobody has set that, either."""


def changed_settings(owner: bpy.types.bpy_struct, held: Collection[str] = (), *, inner: bool = True) -> list[str]:
    """Names, as Blender's interface shows them, of settings that are not at their defaults.

    Parameters
    ----------
    owner
        A data-block, or a part of one. Texts and lists are not looked at.
    held
        Identifiers that are passed over, those of inner groups included.
    inner
        Look into the groups of settings that belong to the owner as well.
    """
    found = []
    for name, label, kind, default in _settings(_kind(owner)):
        if name in held:
            continue
        value = getattr(owner, name, None)
        if kind == "POINTER":
            found += [label] if value is not None else []
        elif kind == "GROUP":
            found += changed_settings(value, held, inner=False) if inner and value is not None else []
        elif not _same(value, default) and not _is_of_startup(owner, name, value):
            found.append(label)
    return list(dict.fromkeys(found))


def listed(text: str, names: Sequence[str]) -> Iterator[str]:
    """The text with the names behind it; nothing without names."""
    if names:
        yield f"{text}: {', '.join(names)}"


def changed_by_row(owners: bpy.types.bpy_prop_collection, held: Collection[str] = ()) -> dict[int, list[str]]:
    """The same for all members of a collection at once, by place; numbers, switches and choices only."""
    found: dict[int, list[str]] = {}
    kind = _kind(owners[0]) if len(owners) else None
    for name, label, form, default in _settings(kind) if kind is not None else ():
        if name in held or form not in NUMBERS or isinstance(default, set):
            continue
        for row in _changed_rows(owners, name, form, default):
            found.setdefault(int(row), []).append(label)
    return found


def _changed_rows(owners: bpy.types.bpy_prop_collection, name: str, form: str, default: Any) -> NDArray[np.int64]:
    if form == "ENUM":
        items = owners[0].bl_rna.properties[name].enum_items
        if default not in items:
            return np.flatnonzero([getattr(owner, name) != default for owner in owners])
        default = items[default].value
    expected = np.asarray(default, NUMBERS[form]).reshape(-1)
    buffer: NDArray = np.empty(len(owners) * expected.size, NUMBERS[form])
    owners.foreach_get(name, buffer)
    values = buffer.reshape(len(owners), expected.size)
    unlike = np.abs(values - expected) > SAME if form == "FLOAT" else values != expected
    return np.array(
        [row for row in np.flatnonzero(unlike.any(axis=1)) if not _is_of_startup(owners[row], name, values[row])],
        np.int64,
    )


def _kind(owner: Any) -> Any:
    return type(owner)


@cache
def _settings(kind: Any) -> list[tuple[str, str, str, Any]]:
    """(identifier, label, kind, default) of what a user can set; kind GROUP for settings in a group of their own."""
    return list(_iterate_settings(kind))


def _iterate_settings(kind: Any) -> Iterator[tuple[str, str, str, Any]]:
    for each in kind.bl_rna.properties:
        label = each.name or each.identifier
        if each.identifier in NO_SETTINGS or each.is_runtime:  # add-ons' are told apart
            continue
        if each.type == "POINTER":
            above = _bases(each.fixed_type)
            if "PropertyGroup" in above:  # of add-ons; asking for it would make it
                continue
            if "ID" not in above:
                yield each.identifier, label, "GROUP", None
            elif not each.is_readonly:
                yield each.identifier, label, "POINTER", None
        elif not each.is_readonly and each.type in NUMBERS:
            new = NEW.get(kind.bl_rna.identifier, {})
            yield each.identifier, label, each.type, new.get(each.identifier, _default(each))


def _default(each: bpy.types.Property) -> Any:
    if each.type == "ENUM":
        return set(each.default_flag) if each.is_enum_flag else each.default
    return tuple(each.default_array) if each.is_array else each.default


def _bases(struct: bpy.types.Struct | None) -> set[str]:
    names = set()
    while struct is not None:
        names.add(struct.identifier)
        struct = struct.base
    return names


def _is_of_startup(owner: Any, name: str, value: Any) -> bool:
    values = STARTUP.get(_kind(owner).bl_rna.identifier, {})
    return name in values and _same(value, values[name])


def _same(value: Any, default: Any) -> bool:
    if isinstance(default, float) and not isinstance(value, str):
        return bool(abs(value - default) <= SAME)
    if isinstance(default, tuple):
        flat = np.asarray(value).reshape(-1)
        return len(flat) != len(default) or bool(np.allclose(flat, default, rtol=0, atol=SAME))
    return bool(value == default)

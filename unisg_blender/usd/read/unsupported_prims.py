"""What a scenegraph cannot hold of the prims of a stage, in words: one warning per kind of loss, with all its prims.

Every authored property and applied schema that no reader knows is told, so that
what nobody thought of is told as well.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from functools import cache
from typing import Any

from pxr import UsdShade

from ...runtime.read_report import Loss
from .. import schema
from .camera_light_prims import CAMERA_NAMES, LIGHT_INPUTS
from .entity_selection import Entities
from .mesh_topology import UV_TYPES

HELD = frozenset((
    "xformOpOrder", "visibility", "purpose", "extent", "extentsHint", "proxyPrim", "points", "faceVertexCounts",
    "faceVertexIndices", "normals", "subdivisionScheme", "orientation", "doubleSided", "size", "radius", "radiusTop",
    "radiusBottom", "height", "axis", "width", "length", "curveVertexCounts", "prototypes", "protoIndices",
    "positions", "orientations", "orientationsf", "scales", "ids", "invisibleIds", "joints", "bindTransforms",
    "restTransforms", "primvars:normals", "colorSpace:name", "trs", schema.LABELS, "physics:mass",
    "physics:approximation", *CAMERA_NAMES,
    *(f"inputs:{name}" for name in LIGHT_INPUTS),
))  # fmt: skip
HELD_BEGINNINGS = ("xformOp:", "unisg:", schema.USER, "material:binding", "subsetFamily:", "collection:lightLink:",
                   "collection:shadowLink:", "collection:filterLink:")  # fmt: skip
HELD_SCHEMAS = frozenset((
    "MaterialBindingAPI", "LightAPI", "ShapingAPI", "ShadowAPI", "GeomModelAPI", "SkelBindingAPI", "ColorSpaceAPI",
    "SemanticsLabelsAPI", "PhysicsRigidBodyAPI", "PhysicsMassAPI", "PhysicsCollisionAPI", "PhysicsMeshCollisionAPI",
))  # fmt: skip
OF_MATERIALS = frozenset(("Material", "Shader", "NodeGraph", "GeomSubset"))
OF_TYPES = {
    "Volume": "the fields of volumes are not read",
    "NurbsPatch": "of patches only the control points are read",
    "TetMesh": "of tetrahedra only the points are read",
    "Skeleton": "skeletons keep their place, not their bones",
    "BasisCurves": "curves are read as edges between their points, without widths and basis",
    "NurbsCurves": "curves are read as edges between their points, without widths and knots",
    "HermiteCurves": "curves are read as edges between their points, without tangents",
    "DomeLight": "lights of this kind keep their place only",
    "DomeLight_1": "lights of this kind keep their place only",
    "CylinderLight": "lights of this kind keep their place only",
    "GeometryLight": "lights of this kind keep their place only",
    "PortalLight": "lights of this kind keep their place only",
    "PluginLight": "lights of this kind keep their place only",
}
CURVES = frozenset(("widths", "basis", "type", "wrap", "knots", "order", "ranges", "tangents", "pointWeights"))
IDLE: dict[str, Any] = {
    "ior": 1.5, "clearcoat": 0.0, "clearcoatRoughness": 0.01, "useSpecularWorkflow": 0, "occlusion": 1.0,
    "displacement": 0.0, "opacityThreshold": 0.0, "opacityMode": "transparent",
}  # fmt: skip
SURFACE = frozenset(f"inputs:{name}" for name in ("diffuseColor", "opacity", "metallic", "roughness"))


def tell_losses(found: Entities) -> None:
    """Warn of what is lost of the entities, their shapes and what was left out between them."""
    lost: dict[str, list[str]] = {}
    for prim, reason in found.left_out:
        if prim.GetTypeName() not in OF_MATERIALS:
            lost.setdefault(reason, []).append(str(prim.GetPath()))
    for prim, shape in zip(found.prim, found.shape, strict=True):
        for each in (prim,) if shape is None or shape == prim else (prim, shape):
            for text in _losses(each):
                lost.setdefault(text, []).append(str(each.GetPath()))
    for text, paths in lost.items():
        warnings.warn(Loss(text, paths), stacklevel=2)


def _losses(prim: Any) -> Iterator[str]:
    kind = str(prim.GetTypeName())
    authored = tuple(prim.GetAuthoredPropertyNames())
    yield from _unknown(kind, tuple(name for name in _candidates(authored) if not _is_held(prim, name)))
    schemas = tuple(prim.GetAppliedSchemas())
    if schemas:
        yield from _unknown_schemas(schemas)
    if kind in OF_TYPES:
        yield OF_TYPES[kind]
    if prim.HasVariantSets():
        yield "only the selected variants are read"
    if kind == "Mesh":
        yield from _mesh_losses(prim)
    if "visibility" in authored and prim.GetAttribute("visibility").ValueMightBeTimeVarying():
        yield "visibility that changes with time is read at its first moment"


@cache
def _candidates(names: tuple[str, ...]) -> tuple[str, ...]:
    """Names out of a prim's authored properties that are not read from every prim."""
    return tuple(name for name in names if name not in HELD and not name.startswith(HELD_BEGINNINGS))


def _is_held(prim: Any, name: str) -> bool:
    if name.startswith("primvars:"):
        return name.endswith(":indices") or str(prim.GetAttribute(name).GetTypeName()) in UV_TYPES
    attribute = prim.GetAttribute(name)
    return bool(attribute and attribute.IsCustom())


@cache
def _unknown(kind: str, names: tuple[str, ...]) -> tuple[str, ...]:
    """Words for authored properties that nothing reads."""
    texts = []
    left = list(names)
    if any(name.startswith(("skel:", "primvars:skel:")) for name in left):
        texts.append("skinning and blend shapes: only the first pose is kept")
    if any(name in ("primvars:displayColor", "primvars:displayOpacity") for name in left):
        texts.append("vertex colours are not read")
    if any(name.startswith("physics:") for name in left):
        texts.append("physics beside bodies, masses and colliders is not read")
    known = ("skel:", "primvars:skel:", "primvars:displayColor", "primvars:displayOpacity", "physics:")
    left = [name for name in left if not name.startswith(known) and not (kind.endswith("Curves") and name in CURVES)]
    return (*texts, f"{', '.join(left)} not read") if left else tuple(texts)


@cache
def _unknown_schemas(names: tuple[str, ...]) -> tuple[str, ...]:
    left = [name for name in names if name.split(":")[0] not in HELD_SCHEMAS and not name.startswith("Collection")]
    physics = ("physics beside bodies, masses and colliders is not read",) * any(
        name.startswith("Physics") for name in left
    )
    others = [name for name in left if not name.startswith("Physics")]
    return (*physics, *((f"the schemas {', '.join(others)} are not read",) if others else ()))


def _mesh_losses(mesh: Any) -> Iterator[str]:
    scheme = mesh.GetAttribute("subdivisionScheme").Get()
    if scheme not in ("none", None):
        yield f"subdivision ({scheme}) is not read"
    if mesh.GetAttribute("points").GetNumTimeSamples() > 1:
        yield "points that move are read at their first moment"


def material_losses(material: Any) -> Iterator[str]:
    """What is lost of a material that something shows."""
    shader = material.ComputeSurfaceSource()[0]
    if not shader:
        return
    if shader.GetShaderId() not in ("UsdPreviewSurface", ""):
        yield "of other surfaces than UsdPreviewSurface only colour, metallic and roughness are read"
    authored = [entry for entry in shader.GetInputs() if entry.GetAttr().IsAuthored()]
    if any(_is_textured(entry) for entry in authored):
        yield "textures are not read"
    if any(f"inputs:{entry.GetBaseName()}" not in SURFACE and not _is_idle(entry) for entry in authored):
        yield "surface properties beyond colour, opacity, metallic and roughness are not read"


def _is_textured(entry: Any) -> bool:
    sources = UsdShade.Utils.GetValueProducingAttributes(entry)
    return bool(sources) and UsdShade.Utils.GetType(sources[0].GetName()) == UsdShade.AttributeType.Output


def _is_idle(entry: Any) -> bool:
    """Whether an input of a preview surface is where it does nothing."""
    name, value = entry.GetBaseName(), entry.Get()
    if name in ("emissiveColor", "specularColor", "normal"):
        return not any(value or ()) or (name == "normal" and tuple(value) == (0, 0, 1))
    return name in IDLE and (value == IDLE[name] or (isinstance(value, float) and abs(value - IDLE[name]) < 1e-6))

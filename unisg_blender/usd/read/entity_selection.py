"""Which prims of a stage are entities, and which are only their shapes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from pxr import Usd, UsdGeom, UsdLux, UsdSkel

from ...errors import UniSGError
from .. import schema
from .nesting import DEEPEST

SEEN = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
ALL = Usd.TraverseInstanceProxies(Usd.PrimIsActive & Usd.PrimIsLoaded)
SHAPES = ("MESH", "CURVE", "POINTCLOUD", "CAMERA", "LIGHT", "VOLUME", "ARMATURE")
_KINDS = (
    (UsdGeom.Camera, "CAMERA"),
    (UsdGeom.BasisCurves, "CURVE"),
    (UsdGeom.NurbsCurves, "CURVE"),
    (UsdGeom.HermiteCurves, "CURVE"),
    (UsdGeom.Points, "POINTCLOUD"),
    (UsdSkel.Skeleton, "ARMATURE"),
    (UsdGeom.PointInstancer, "INSTANCER"),
    (UsdGeom.Gprim, "MESH"),
    (UsdGeom.Scope, "SCOPE"),
    (UsdGeom.Imageable, "EMPTY"),
)


@dataclass
class Entities:
    """Prims that become entities, parents first; ``parent`` holds positions in these lists, -1 for roots.

    ``left_out``: prims that were passed over with all below them, and why.
    """

    prim: list[Any] = field(default_factory=list)
    shape: list[Any] = field(default_factory=list)
    kind: list[str] = field(default_factory=list)
    parent: list[int] = field(default_factory=list)
    instances: list[tuple[int, Any]] = field(default_factory=list)
    hidden: list[bool] = field(default_factory=list)
    left_out: list[tuple[Any, str]] = field(default_factory=list)


def find_entities(tops: Iterable[Any], nested: bool = False) -> Entities:
    """The entities in and under some prims.

    An Xform with one shape below it that has no transform of its own is one
    entity with that shape. Shaders, guides, proxies and empty scopes are left
    out; native instances and point instancers that stand for the component
    ``instances`` are listed apart with the position of their entity.

    Parameters
    ----------
    tops
        The prims to begin with.
    nested
        True reads prims that a stage does not show by itself (classes, overs), as prototypes may be.

    Raises
    ------
    UniSGError
        If prims nest deeper than :data:`~.nesting.DEEPEST`: binary files are not looked at before USD reads them.
    """
    found = Entities()
    rows: dict[Any, int] = {}
    kinds: dict[str, str] = {}
    for top in tops:
        walk = iter(Usd.PrimRange(top, ALL if nested else SEEN))
        for prim in walk:
            name = prim.GetTypeName()
            kind = kinds.get(name) or kinds.setdefault(name, _kind(prim))
            path = prim.GetPath()
            if path.pathElementCount > DEEPEST:
                raise UniSGError(f"{str(path)[:60]} ...: prims nest deeper than the {DEEPEST} that can be read")
            above = rows.get(path.GetParentPath(), -1)
            purpose = "" if kind == "SKIP" else _purpose(prim)
            if kind == "SKIP" or _is_own_scope(prim, kind) or purpose in ("guide", "proxy"):
                if not _is_own_scope(prim, kind):
                    found.left_out.append((prim, f"{prim.GetTypeName() if kind == 'SKIP' else purpose} is left out"))
                walk.PruneChildren()
                continue
            if kind == "INSTANCER" or (prim.IsInstance() and prim.HasAttribute(schema.SOURCE)):
                walk.PruneChildren()
                own = prim.HasAttribute(schema.SOURCE) and above >= 0
                found.instances.append((above if own else len(found.prim), prim))
                if own:
                    continue
            hidden = _invisible(prim) or (above >= 0 and found.hidden[above])
            rows[path] = len(found.prim)
            found.prim.append(prim)
            found.kind.append(kind)
            found.parent.append(above)
            found.hidden.append(hidden)
    return _merged(found)


def _kind(prim: Any) -> str:
    if not prim.GetTypeName():
        return "EMPTY"
    if prim.HasAPI(UsdLux.LightAPI) and not prim.IsA(UsdGeom.Gprim):
        return "LIGHT"
    if prim.GetTypeName() == "Volume":
        return "VOLUME"
    for schema_class, kind in _KINDS:
        if prim.IsA(schema_class):
            return kind
    known = Usd.SchemaRegistry().FindConcretePrimDefinition(prim.GetTypeName())
    return "SKIP" if known else "EMPTY"


def _is_own_scope(prim: Any, kind: str) -> bool:
    return kind == "SCOPE" and prim.GetName() in schema.SCOPES


def _purpose(prim: Any) -> str:
    attribute = prim.GetAttribute("purpose")
    return str(attribute.Get() or "") if attribute.HasAuthoredValue() else ""


def _invisible(prim: Any) -> bool:
    attribute = prim.GetAttribute("visibility")
    return bool(attribute.HasAuthoredValue() and attribute.Get(Usd.TimeCode.EarliestTime()) == "invisible")


def _merged(found: Entities) -> Entities:
    """Shapes joined with the Xforms that only carry them; scopes without entities left out."""
    count = len(found.prim)
    shapes: dict[int, list[int]] = {}
    for row in range(count):
        if found.parent[row] >= 0 and found.kind[row] in SHAPES and found.kind[found.parent[row]] == "EMPTY":
            shapes.setdefault(found.parent[row], []).append(row)
    has_children = set(found.parent)
    shape_of: dict[int, int] = {}
    for above, below in shapes.items():
        plain = [row for row in below if row not in has_children and _only_shape(found.prim[row])]
        if (len(below) == 1 and plain) or (plain and found.prim[above].HasAttribute(schema.UID)):
            shape_of[above] = plain[0]
    dropped = set(shape_of.values())
    kept_children = [0] * count
    for row in reversed(range(count)):
        if found.kind[row] == "SCOPE" and not kept_children[row]:
            dropped.add(row)
        if row not in dropped and found.parent[row] >= 0:
            kept_children[found.parent[row]] += 1
    place = {-1: -1}
    merged = Entities(left_out=found.left_out)
    for row in range(count):
        if row in dropped:
            continue
        shape = shape_of.get(row, row)
        place[row] = len(merged.prim)
        merged.prim.append(found.prim[row])
        merged.shape.append(found.prim[shape] if found.kind[shape] in SHAPES else None)
        merged.kind.append("EMPTY" if found.kind[shape] in ("SCOPE", "INSTANCER") else found.kind[shape])
        merged.parent.append(place[found.parent[row]])
        merged.hidden.append(found.hidden[row] or found.hidden[shape])
    merged.instances = [(place[row], prim) for row, prim in found.instances]
    return merged


def _only_shape(prim: Any) -> bool:
    """True if a shape has no transform and no identity of its own."""
    order = prim.GetAttribute("xformOpOrder")
    return not (order.HasAuthoredValue() and order.Get()) and not prim.HasAttribute(schema.UID)

"""Points, directions, planes and poses as multivectors of PGA, and back: a pair ``embed_x``, ``extract_x`` for each.

The conventions are those of docs/poses.md: a point is e123 - x e023 + y e013 - z e012, a motor M moves it by M p ~M.
"""

from __future__ import annotations

import torch
from torch import Tensor

from ...poses import FORMS
from ...poses.multivectors import PGA_BLADES

SMALLEST = 1e-6
"""Weights and lengths below this count as this, so that what a network gave can always be read."""

_E0, _E1, _E012, _E013, _E023, _E123 = (PGA_BLADES.index(name) for name in ("e0", "e1", "e012", "e013", "e023", "e123"))


def embed_direction(directions: Tensor) -> Tensor:
    """Directions or displacements (..., 3), metres, as points at infinity (..., 16); shifts do not change them."""
    x, y, z = directions.unbind(-1)
    none = torch.zeros_like(x)
    return torch.stack([*[none] * _E012, -z, y, -x, none, none], dim=-1)


def extract_direction(multivectors: Tensor) -> Tensor:
    """Displacements (..., 3) of multivectors (..., 16)."""
    return torch.stack([-multivectors[..., _E023], multivectors[..., _E013], -multivectors[..., _E012]], dim=-1)


def embed_point(points: Tensor) -> Tensor:
    """Points (..., 3), metres, as multivectors (..., 16) of weight 1."""
    origin = torch.zeros(16, dtype=points.dtype, device=points.device)
    origin[_E123] = 1
    return embed_direction(points) + origin


def extract_point(multivectors: Tensor) -> Tensor:
    """Points (..., 3), metres, of multivectors (..., 16), whatever their weight and sign."""
    weight = multivectors[..., _E123, None]
    size = weight.abs().clamp(min=SMALLEST)
    return extract_direction(multivectors) / torch.where(weight < 0, -size, size)


def embed_plane(normals: Tensor, distances: Tensor) -> Tensor:
    """Planes n x = d of normals (..., 3) and distances (...) from the origin, metres, as vectors n - d e0 (..., 16)."""
    some = torch.cat([-distances.unsqueeze(-1), normals], dim=-1)
    before, after = (torch.zeros_like(some[..., :1]).expand(*some.shape[:-1], count) for count in (1, 11))
    return torch.cat([before, some, after], dim=-1)


def extract_plane(multivectors: Tensor) -> tuple[Tensor, Tensor]:
    """Unit normals (..., 3) and distances (...), metres, of multivectors (..., 16), whatever their size."""
    normal = multivectors[..., _E1 : _E1 + 3]
    size = normal.norm(dim=-1, keepdim=True).clamp(min=SMALLEST)
    return normal / size, -multivectors[..., _E0] / size.squeeze(-1)


def embed_motor(matrices: Tensor) -> Tensor:
    """Rigid poses (..., 4, 4) as motors (..., 16), the form ``pga``.

    As the motion that it stands for, a motor M turns into N M ~N under a motion N. As an object's pose it turns into
    N M, and the sign of N M may jump: give a network that is to be equivariant :func:`embed_frame`.
    """
    return FORMS["pga"].encode(matrices)


def extract_motor(multivectors: Tensor) -> Tensor:
    """The nearest rigid poses (..., 4, 4) of multivectors (..., 16); PoseError without a rotor."""
    form = FORMS["pga"]
    return form.decode(form.project(multivectors))


def embed_frame(matrices: Tensor) -> Tensor:
    """Poses (..., 4, 4) as what stands still in them: the origin and the three planes through it, (..., 4, 16).

    The whole of a rigid pose without a choice of sign, and linear in the matrix: the gradient is the same everywhere.
    """
    origin, axes = matrices[..., :3, 3], matrices[..., :3, :3].transpose(-1, -2)
    planes = embed_plane(axes, (axes @ origin.unsqueeze(-1)).squeeze(-1))
    return torch.cat([embed_point(origin).unsqueeze(-2), planes], dim=-2)

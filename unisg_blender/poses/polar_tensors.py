"""The polar rotation of tensors as one operator of torch: its gradient, and what ``vmap`` and recorders need to know.

R is the gradient of the nuclear norm of A, so its derivative is a symmetric map:
one formula serves backward and forward differentiation.
"""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from .arrays import Components, is_recorded
from .polar_values import rotation_values
from .rotations import cofactors, cross, dot, scale
from .stretch import stretch_of, twist_of


def differentiable_rotation(a: Components, mirrored: bool) -> Components:
    """Rotations of blocks, nine tensors of any one shape; see ``polar.pose_rotation``."""
    operator = _rotation if is_recorded() else _Rotation.apply  # recorders do not see into a class with ``jvp``
    return operator(torch.stack(tuple(a)), mirrored).unbind(0)


def _values(a: Tensor, mirrored: bool) -> Tensor:
    return torch.stack(tuple(rotation_values(a.reshape(9, -1).unbind(0), mirrored))).reshape(a.shape)


@torch.library.custom_op("unisg_blender::polar_rotation", mutates_args=())
def _rotation(a: Tensor, mirrored: bool) -> Tensor:
    """Rotations (9, ...) of blocks (9, ...)."""
    return _values(a, mirrored)


@_rotation.register_fake
def _(a: Tensor, mirrored: bool) -> Tensor:
    return torch.empty_like(a)


def _save(ctx: Any, inputs: tuple[Tensor, bool], output: Tensor) -> None:
    ctx.save_for_backward(inputs[0], output)


def _backward(ctx: Any, change: Tensor) -> tuple[Tensor, None]:
    a, r = ctx.saved_tensors
    return _derivative(a, r, change), None


_rotation.register_autograd(_backward, setup_context=_save)


class _Rotation(torch.autograd.Function):
    """The same operator for ``torch.func`` and forward differentiation, which ask for a class."""

    @staticmethod
    def forward(a: Tensor, mirrored: bool) -> Tensor:
        """Rotations (9, ...)."""
        return _values(a, mirrored)

    @staticmethod
    def vmap(info: Any, in_dims: tuple[int, None], a: Tensor, mirrored: bool) -> tuple[Tensor, int]:
        """One axis more changes nothing."""
        return _Rotation.apply(a.movedim(in_dims[0], -1), mirrored), -1

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Tensor, bool], output: Tensor) -> None:
        """Keep the block and its rotation."""
        _save(ctx, inputs, output)
        ctx.save_for_forward(inputs[0], output)

    @staticmethod
    def backward(ctx: Any, *changes: Tensor) -> tuple[Tensor, None]:
        """Gradient of the block."""
        return _backward(ctx, *changes)

    @staticmethod
    def jvp(ctx: Any, *changes: Any) -> Tensor:
        """Change of the rotation."""
        return _backward(ctx, changes[0])[0]


def _derivative(a: Tensor, r: Tensor, change: Tensor) -> Tensor:
    """dR of dA, each (9, ...).

    dR = R hat(w) with (tr(S) 1 - S) w = axial(R^T dA - dA^T R); zero where the rotation has no derivative.
    """
    size = a.detach().abs().amax(0)
    size = torch.where(size > 0, size, 1.0)
    rows = r.unbind(0)
    xx, yy, zz, xy, xz, yz = stretch_of(rows, (a / size).unbind(0))
    m = (yy + zz, -xy, -xz, -xy, xx + zz, -yz, -xz, -yz, xx + yy)
    cofactor, determinant = cofactors(m)
    flat = determinant.abs() <= 16.0 * torch.finfo(a.dtype).eps * dot(m, m) ** 1.5
    factor = torch.where(flat, 0.0, 1.0 / torch.where(flat, 1.0, determinant * size))
    twist = twist_of(rows, change.unbind(0))
    turn = scale(factor, tuple(dot(cofactor[3 * i : 3 * i + 3], twist) for i in range(3)))
    return torch.stack([c for i in range(3) for c in cross(rows[3 * i : 3 * i + 3], turn)])

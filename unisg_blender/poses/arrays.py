"""Formulas on components, applied to batches of numpy arrays or torch tensors.

Every formula of this room is written once, on *components*: a pose's channels
as separate arrays of one shape, combined with ordinary arithmetic and the few
functions that numpy and torch share under one name. ``map_rows`` cuts a batch
into components. In numpy it works through the batch in blocks that stay in the
processor's cache, always in float64; a tensor is done in one piece, in its own
dtype, so that gradients flow.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Sequence
from types import ModuleType
from typing import Any

import numpy as np

from ..errors import UniSGError

Components = Sequence[Any]  # one array per channel, all of one shape; a plain number stands for a constant channel
Formula = Callable[[Components], Components]

NO_NORM = "has a norm of zero"

BLOCK = 6000  # rows per block: 16 channels of float64 fit the second-level cache; no power of 2, whose strides collide


class PoseError(UniSGError, ValueError):
    """Numbers that are no pose: wrong shape, NaN, infinity, or a versor of norm zero. Names the row."""


def is_tensor(array: object) -> bool:
    """Whether ``array`` is a torch tensor; never imports torch."""
    torch = sys.modules.get("torch")
    return torch is not None and isinstance(array, torch.Tensor)


def is_recorded() -> bool:
    """Whether torch records operators (compiles, exports, traces) and there are no values to look at."""
    torch = sys.modules["torch"]
    return bool(torch.compiler.is_compiling() or torch.jit.is_tracing())


def namespace(array: object) -> ModuleType:
    """The module whose functions fit ``array``: torch for a tensor, else numpy."""
    return sys.modules["torch"] if is_tensor(array) else np


def as_batch(array: Any, item: tuple[int, ...], what: str) -> Any:
    """``array`` as a numeric numpy array or a floating tensor of shape (..., *item).

    Raises
    ------
    PoseError
        Where the trailing shape is not ``item``, or the values are not real numbers.
    """
    if is_tensor(array):
        batch = array if array.is_floating_point() else array.to(sys.modules["torch"].get_default_dtype())
    else:
        try:
            batch = np.asarray(array)
        except ValueError as error:
            raise PoseError(f"{what} must be an array of shape (..., {_commas(item)}): {error}") from None
        if batch.dtype.kind not in "fiub":
            raise PoseError(f"{what} must be real numbers, not {batch.dtype}")
    if tuple(batch.shape[max(batch.ndim - len(item), 0) :]) != item:
        raise PoseError(f"{what} must have the shape (..., {_commas(item)}), not {tuple(batch.shape)}")
    return batch


def map_rows(
    function: Formula, batch: Any, item: tuple[int, ...], out: tuple[int, ...], what: str, cause: str = NO_NORM
) -> Any:
    """Apply a formula on components to every item of a batch.

    Parameters
    ----------
    function
        Takes one array per number of an item, returns one per number of a result.
    batch
        Array or tensor of shape (..., *item), checked by ``as_batch``.
    item, out
        Shape of one item and of one result.
    what, cause
        What an item is, and why one may have no result, for error messages.

    Returns
    -------
    array or tensor
        Shape (..., *out); float32 where ``batch`` was float32 or float16, else
        float64; a tensor keeps its dtype.

    Raises
    ------
    PoseError
        Naming the first row that holds NaN or infinity, or has no result.
    """
    problems = (f"{what} holds NaN or infinity", f"{what} {cause}, or is out of range")
    return (_map_tensor if is_tensor(batch) else _map_blocks)(function, batch, item, out, problems)


def _map_blocks(
    function: Formula, batch: np.ndarray, item: tuple[int, ...], out: tuple[int, ...], problems: tuple[str, str]
) -> np.ndarray:
    leading = batch.shape[: batch.ndim - len(item)]
    rows = batch.reshape(math.prod(leading), math.prod(item))
    single = rows.dtype.kind == "f" and rows.dtype.itemsize <= 4
    result = np.empty((len(rows), math.prod(out)), np.float32 if single else np.float64)  # zeros: no huge pages
    with np.errstate(all="ignore"):  # a row without a result shows as NaN, and is named below
        for start in range(0, len(rows), BLOCK):
            block = rows[start : start + BLOCK]
            _check_finite(block, start, leading, problems[0])
            written = result[start : start + BLOCK]
            written[...] = 0.0
            for channel, values in enumerate(function(tuple(np.ascontiguousarray(block.T, dtype=np.float64)))):
                if not (isinstance(values, float) and values == 0.0):
                    written[:, channel] = values
            _check_finite(written, start, leading, problems[1])
    return result.reshape(leading + out)


def _map_tensor(
    function: Formula, batch: Any, item: tuple[int, ...], out: tuple[int, ...], problems: tuple[str, str]
) -> Any:
    torch = sys.modules["torch"]
    checked = not (is_recorded() or torch._C._are_functorch_transforms_active())  # under vmap no value is one value
    rows = batch.flatten(batch.ndim - len(item))
    if checked:
        _check_tensor(rows, problems[0])
    constant = rows[..., 0].detach()
    channels = [torch.full_like(constant, c) if isinstance(c, float) else c for c in function(rows.unbind(-1))]
    result = torch.stack(channels, -1)
    if checked:
        _check_tensor(result, problems[1])
    return result.unflatten(-1, out)


def _check_tensor(rows: Any, problem: str) -> None:
    good = rows.detach().isfinite().all(-1)
    if not bool(good.all()):
        raise _named((~good).nonzero()[0].tolist(), problem)


def _check_finite(block: np.ndarray, start: int, leading: tuple[int, ...], problem: str) -> None:
    flat = block.ravel(order="K")
    if flat.dtype.kind != "f" or np.isfinite(flat @ flat):  # one pass at memory speed; exact look only where it fails
        return
    good = np.isfinite(block).all(axis=-1)
    if not good.all():
        raise _named(np.unravel_index(start + int(np.argmin(good)), leading), problem)


def _named(index: Sequence[Any], problem: str) -> PoseError:
    place = f"row {_commas(tuple(int(i) for i in index))}: " if len(index) else ""
    return PoseError(place + problem)


def _commas(numbers: tuple[int, ...]) -> str:
    return ", ".join(str(n) for n in numbers)

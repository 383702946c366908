"""Examples of different sizes as one batch."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import torch
from numpy.typing import ArrayLike
from torch import Tensor


def padded_stack(arrays: Sequence[ArrayLike]) -> Tensor:
    """B arrays of one kind and number of axes as (B, ...), with zeros up to the largest size of each axis, at least 1.

    The type is the first array's.
    """
    parts = [np.asarray(array) for array in arrays]
    sizes = np.array([part.shape for part in parts], np.int64).max(axis=0, initial=1)
    whole = np.zeros((len(parts), *sizes), parts[0].dtype)
    for number, part in enumerate(parts):
        whole[(number, *map(slice, part.shape))] = part
    return torch.from_numpy(whole)

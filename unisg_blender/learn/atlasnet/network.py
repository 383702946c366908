"""AtlasNet as torch networks: a PointNet encoder and a decoder of closed sphere patches.

Groueix et al., "AtlasNet: A Papier-Mâché Approach to Learning 3D Surface
Generation", CVPR 2018; the encoder is that of Qi et al., "PointNet", CVPR 2017,
without its transform networks.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import torch
from torch import Tensor, nn

from ...meshes.atlasnet_sessions import FEATURE_WIDTH
from ..tensor_rows import largest, pick
from .patch_decoder import PatchDecoder, draw_template


class PointNetEncoder(nn.Module):
    """Points (B, n, 3) in the unit sphere to features (B, 1024): 3-64-128-1024 with batch norm, then the maximum.

    The layers are linear on flattened points (the same as convolutions of width
    1, and faster on a CPU).
    """

    def __init__(self) -> None:
        super().__init__()
        widths = (3, 64, 128, FEATURE_WIDTH)
        self.layers = nn.ModuleList(nn.Linear(a, b) for a, b in pairwise(widths))
        self.norms = nn.ModuleList(nn.BatchNorm1d(width) for width in widths[1:])

    def forward(self, points: Tensor) -> Tensor:
        """Point clouds (B, N, 3) to features (B, width)."""
        batch, count = points.shape[0], points.shape[1]
        hidden = points.reshape(batch * count, 3)
        for layer, norm in zip(self.layers[:-1], self.norms[:-1], strict=True):
            hidden = norm(layer(hidden)).relu()
        return _pooled(hidden.reshape(batch, count, -1), self.layers[-1], self.norms[-1])

    def folded(self) -> FoldedEncoder:
        """The same function as of evaluation, with the batch norms multiplied into the layers."""
        return FoldedEncoder([fold(layer, norm) for layer, norm in zip(self.layers, self.norms, strict=True)])


class FoldedEncoder(nn.Module):
    """An encoder of linear layers only, for export.

    The points are the last axis where the maximum is taken over them, which a
    CPU does twice as fast; the last bias is added after it.
    """

    def __init__(self, layers: list[nn.Linear]) -> None:
        super().__init__()
        self.layers = nn.ModuleList(layers)

    def forward(self, points: Tensor) -> Tensor:
        """Point clouds (B, N, 3) to features (B, width), batch norms folded in."""
        hidden = points.reshape(-1, 3)
        for layer in self.layers[:-1]:
            hidden = layer(hidden).relu()
        last = self.layers[-1]
        assert isinstance(last, nn.Linear)
        hidden = hidden.reshape(points.shape[0], -1, last.in_features).transpose(1, 2)
        return torch.matmul(last.weight, hidden).amax(dim=2) + last.bias


def fold(layer: nn.Module, norm: nn.Module) -> nn.Linear:
    """One linear layer that does what ``norm(layer(x))`` does in evaluation."""
    assert isinstance(layer, nn.Linear)
    assert isinstance(norm, nn.BatchNorm1d)
    assert norm.running_mean is not None
    assert norm.running_var is not None
    gain = norm.weight / torch.sqrt(norm.running_var + norm.eps)
    folded = nn.Linear(layer.in_features, layer.out_features)
    folded.weight.data = layer.weight.data * gain.data[:, None]
    folded.bias.data = (layer.bias.data - norm.running_mean) * gain.data + norm.bias.data
    return folded


def _pooled(hidden: Tensor, layer: nn.Module, norm: nn.Module) -> Tensor:
    """``norm(layer(hidden)).amax(1)`` for hidden (B, n, k), computed for the winning points only.

    Only the winner of each channel has a gradient, and the mean and variance of a
    linear map follow from those of its input: four times faster than the whole.
    """
    assert isinstance(layer, nn.Linear)
    assert isinstance(norm, nn.BatchNorm1d)
    assert norm.running_mean is not None
    assert norm.running_var is not None
    with torch.no_grad():
        score = torch.matmul(layer.weight * norm.weight.sign()[:, None], hidden.transpose(1, 2))
        winner = largest(score)
    won = pick(hidden, winner)
    value = (won * layer.weight).sum(2) + layer.bias
    mean, variance = norm.running_mean, norm.running_var
    if norm.training:
        flat = hidden.reshape(-1, hidden.shape[2])
        middle = flat.mean(dim=0)
        centred = flat - middle
        mean = layer.weight @ middle + layer.bias
        variance = ((layer.weight @ (centred.T @ centred / len(flat))) * layer.weight).sum(1)
        norm.running_mean.lerp_(mean.detach(), 0.1)
        norm.running_var.lerp_(variance.detach(), 0.1)
    return (value - mean) * torch.rsqrt(variance + norm.eps) * norm.weight + norm.bias


class AtlasNet(nn.Module):
    """Encoder and decoder together."""

    def __init__(self, patches: int = 16, width: int = 64, depth: int = 2) -> None:
        super().__init__()
        self.encoder = PointNetEncoder()
        self.decoder = PatchDecoder(patches, width, depth)

    def forward(self, points: Tensor, count: int, generator: np.random.Generator) -> Tensor:
        """Points (B, n, 3) to ``count`` random points (B, count, 3) of the reconstructed surfaces."""
        frames, codes = self.decoder.layout(self.encoder(points))
        return self.decoder.place(frames, codes, *draw_template(frames, count, generator))

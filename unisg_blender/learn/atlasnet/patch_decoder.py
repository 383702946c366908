"""AtlasNet's decoder: several closed sphere patches, each laid out by the feature and then bent."""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor, nn

from ...meshes.atlasnet_sessions import FEATURE_WIDTH
from ...meshes.sphere import fibonacci_sphere

FRAME = 7
"""Rows of a patch's frame: images of the axes of the sphere and of the box around it, and a shift."""
TRUNK = 512


class PatchDecoder(nn.Module):
    """Features (B, 1024) and points of unit spheres (B, m, 3), each of a patch (B, m), to surface points (B, m, 3).

    A point s of patch k goes to ``[s, box(s), 1] F + MLP(c, s)``, where box(s) is s
    pushed out to the surface of a cube, and the frame F (7, 3) and the code c of
    the patch follow from the feature. So a patch starts as an ellipsoid or a box
    of any size and skew, and the MLP, common to all patches, bends it. Where a
    point goes depends on nothing but feature, patch and point: any triangulation
    of a sphere becomes a closed part. (AtlasNet's own patches each have an MLP.)
    """

    def __init__(self, patches: int = 16, width: int = 64, depth: int = 2) -> None:
        super().__init__()
        self.patches, self.width = patches, width
        self.trunk = nn.Linear(FEATURE_WIDTH, TRUNK)
        self.frame = nn.Linear(TRUNK, patches * FRAME * 3)
        self.codes = nn.Linear(TRUNK, patches * width)
        self.template = nn.Linear(6, width)
        self.layers = nn.ModuleList(nn.Linear(width, width) for _ in range(depth - 1))
        self.last = nn.Linear(width, 3)
        self._start_apart()

    def _start_apart(self) -> None:
        """At first the patches are small round boxes all around the middle."""
        start = torch.zeros(self.patches, FRAME, 3)
        start[:, :3] = start[:, 3:6] = 0.1 * torch.eye(3)
        start[:, 6] = 0.4 * torch.from_numpy(fibonacci_sphere(self.patches)).float()
        with torch.no_grad():
            self.frame.weight.mul_(0.3)
            self.frame.bias.copy_(start.flatten())
            self.last.weight.mul_(0.1)
            self.last.bias.zero_()

    def forward(self, feature: Tensor, sphere: Tensor, patch: Tensor) -> Tensor:
        """Features (B, width), points of the sphere and of the patches to points of the surface."""
        return self.place(*self.layout(feature), sphere, patch)

    def layout(self, feature: Tensor) -> tuple[Tensor, Tensor]:
        """Frames (B, P, 21) and codes (B, P, width) of the patches."""
        hidden = self.trunk(feature).relu()
        return self.frame(hidden).unflatten(1, (self.patches, -1)), self.codes(hidden).unflatten(1, (self.patches, -1))

    def place(self, frames: Tensor, codes: Tensor, sphere: Tensor, patch: Tensor) -> Tensor:
        """Where points of the spheres go."""
        index = patch[:, :, None]
        box = sphere / sphere.abs().amax(dim=2, keepdim=True)
        inputs = torch.cat([sphere, box], dim=2)
        frame = torch.gather(frames, 1, index.expand(-1, -1, FRAME * 3)).unflatten(2, (FRAME, 3))
        laid = (inputs[:, :, :, None] * frame[:, :, :6]).sum(dim=2) + frame[:, :, 6]
        hidden = (torch.gather(codes, 1, index.expand(-1, -1, self.width)) + self.template(inputs)).relu()
        for layer in self.layers:
            hidden = hidden + layer(hidden).relu()
        return laid + self.last(hidden)


def draw_template(frames: Tensor, count: int, generator: np.random.Generator) -> tuple[Tensor, Tensor]:
    """Random points of the spheres (B, count, 3) and their patches (B, count), even over the laid-out boxes.

    A patch, and a side of it, is drawn as often as its frame (B, P, 21) makes it
    large: the chamfer distance then compares evenly covered surfaces, and a small
    patch is no worse than a large one.
    """
    frame = frames.detach().unflatten(2, (FRAME, 3))
    axes = 0.75 * frame[:, :, :3] + frame[:, :, 3:6]
    sides = torch.stack(
        [torch.linalg.cross(axes[:, :, (k + 1) % 3], axes[:, :, (k + 2) % 3]).norm(dim=2) for k in range(3)], dim=2
    )
    areas = sides + 0.02 * sides.mean(dim=(1, 2), keepdim=True) + 1e-4
    bounds = areas.flatten(1).cumsum(dim=1)
    batch, last = len(frames), bounds.shape[1] - 1
    level = (np.arange(count) + generator.random((batch, count))) / count
    drawn = (level, generator.uniform(-1, 1, (batch, count, 3)), generator.choice([-1.0, 1.0], (batch, count, 1)))
    levels, points, signs = (torch.from_numpy(values).float().to(frames.device) for values in drawn)
    side = torch.searchsorted(bounds, levels * bounds[:, -1:]).clamp(max=last)
    points = points.scatter(2, side[:, :, None] % 3, signs)
    return points / points.norm(dim=2, keepdim=True), side // 3

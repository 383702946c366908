"""A camera as numbers: where it is, what it sees of the world, and which pixel shows what."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

OPENCV = np.diag([1.0, -1.0, -1.0, 1.0])
"""Between the axes of OpenCV's cameras (+X right, +Y down, +Z forward) and Blender's (+X right, +Y up, -Z forward)."""


@dataclass(frozen=True, eq=False)
class CameraView:
    """A camera with square pixels.

    Attributes
    ----------
    name
        What the view is called: "eye 2".
    world
        (4, 4): from the camera's frame to the world's, metres; it looks along -Z with +Y up, as in Blender.
    size
        Width and height in pixels.
    focal
        Pixels in one unit of the picture plane at distance 1; of an orthographic camera pixels in a metre.
    center
        (cx, cy): where the axis meets the picture, in pixels; the middle of the first pixel is at (0.5, 0.5), y down.
    clip
        Metres before which, and beyond which, nothing is seen.
    orthographic
        Whether all rays are parallel.
    """

    name: str
    world: Floats
    size: tuple[int, int]
    focal: float
    center: tuple[float, float]
    clip: tuple[float, float] = (0.05, 200.0)
    orthographic: bool = False

    @property
    def intrinsics(self) -> Floats:
        """K (3, 3): from OpenCV's camera frame to pixels (homogeneous); of an orthographic camera with z = 1."""
        return np.array([[self.focal, 0, self.center[0]], [0, self.focal, self.center[1]], [0, 0, 1]])

    @property
    def extrinsics(self) -> Floats:
        """(4, 4): from the world's frame to OpenCV's camera frame, metres."""
        return np.asarray(OPENCV @ np.linalg.inv(self.world))

    def project(self, points: Floats) -> tuple[Floats, Floats]:
        """Pixels (N, 2) of points (N, 3) in the world, and their depths (N,) along the axis, metres.

        What is behind a camera with perspective has no meaningful pixel.
        """
        seen = points @ self.extrinsics[:3, :3].T + self.extrinsics[:3, 3]
        depth = seen[:, 2]
        flat = seen[:, :2] if self.orthographic else seen[:, :2] / np.where(depth == 0, 1e-12, depth)[:, None]
        return flat * self.focal + np.array(self.center), depth

    def to_record(self) -> dict[str, Any]:
        """JSON-ready, with the conventions in the names."""
        return {
            "view": self.name,
            "width": self.size[0],
            "height": self.size[1],
            "kind": "orthographic" if self.orthographic else "perspective",
            "intrinsics": self.intrinsics.round(9).tolist(),
            "world_to_camera_opencv": self.extrinsics.round(9).tolist(),
            "camera_to_world_blender": self.world.round(9).tolist(),
        }


def looking(
    name: str,
    place: Floats,
    target: Floats,
    size: tuple[int, int],
    angle: float,
    clip: tuple[float, float] = (0.05, 200.0),
) -> CameraView:
    """A camera at a place (3,) that looks at a target (3,), metres; ``angle`` in radians is that of the larger side."""
    back = np.asarray(place, float) - target
    back /= max(float(np.linalg.norm(back)), 1e-12)
    up = np.array([0.0, 0, 1]) if abs(back[2]) < 0.9999 else np.array([0.0, 1, 0])
    right = np.cross(up, back)
    right /= np.linalg.norm(right)
    world = np.eye(4)
    world[:3, :3] = np.column_stack([right, np.cross(back, right), back])
    world[:3, 3] = place
    focal = max(size) / (2 * np.tan(angle / 2))
    return CameraView(name, world, size, float(focal), (size[0] / 2, size[1] / 2), clip)

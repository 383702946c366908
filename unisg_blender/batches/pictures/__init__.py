"""Pictures of rooms with labels: whose each pixel is, how far, and the scenegraph of what is seen."""

from __future__ import annotations

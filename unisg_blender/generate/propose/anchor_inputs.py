"""What the anchor mixture takes: names, in the order of the network's ``forward`` and of the ONNX file, and shapes."""

from __future__ import annotations

from ..observe.scene_tokens import FLAGS, PLAN_WIDTH
from ..observe.support_candidates import OCCUPANCY_WIDTH

PLACE_INPUTS: dict[str, tuple[str | int, ...]] = {
    "target_category": ("targets",), "target_half": ("targets", 3), "target_bottom": ("targets",),
    "plan": ("targets", PLAN_WIDTH), "row": ("targets", "categories"), "latent": ("targets", "latent"),
    "category": ("targets", "tokens"), "box": ("targets", "tokens", 8), "flags": ("targets", "tokens", FLAGS),
    "mask": ("targets", "tokens"),
}  # fmt: skip
"""What a place depends on. Half extents and the height of the target's bottom are metres; ``plan`` and ``row`` say what
is still to come to this surface (:mod:`..observe.scene_tokens`); ``latent`` is drawn from a standard normal, or what
the encoder makes of the true pose; ``box`` is centre, half extents, cosine and sine of the heading."""

SUPPORT_INPUTS: dict[str, tuple[str | int, ...]] = {
    "coming": ("targets", "categories"), "whole": ("targets",), "support_category": ("targets", "supports"),
    "support_holder": ("targets", "supports"), "support_half": ("targets", "supports", 3),
    "support_load": ("targets", "supports", OCCUPANCY_WIDTH), "support_content": ("targets", "supports", "known"),
    "support_near": ("targets", "supports", "known"),
}  # fmt: skip
"""What the choice of a support depends on, beside category and half extents of the target: what is still to come, is
that all, and the candidates (:mod:`..observe.support_candidates`); "known" counts unknown categories as one more."""

CRITIC_INPUTS: dict[str, tuple[str | int, ...]] = {
    "view": ("targets", "tokens", "view"), "place": ("targets", "places", 3),
}  # fmt: skip
"""What the critic asks for beside: the network's ``seen``, and places: x, y (metres) and heading (radians)."""

ANCHOR_INPUTS = PLACE_INPUTS | SUPPORT_INPUTS | CRITIC_INPUTS

INTEGERS = ("target_category", "category", "support_category", "support_holder")
"""Numbers of categories, int64; all others are float32."""

"""What a trained network says about a scene: which object stands on which, and what kind of scene it is. No torch."""

from __future__ import annotations

from .category_model import LabelModel
from .category_proposals import Proposal, accept, propose_categories
from .scene_kind import SceneModel
from .support_prediction import TopologyModel, with_relations

__all__ = [
    "LabelModel", "Proposal", "SceneModel", "TopologyModel", "accept", "propose_categories", "with_relations",
]  # fmt: skip

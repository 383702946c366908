"""How places are drawn from what a model says: what operators and the panel both ask for."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

if TYPE_CHECKING:
    from ...unisg_blender.generate import Sampling


class VarietyChoice:
    """How much of it is chance. ``SKIP_SAVE``: an operator must not take what a button leaves out from before."""

    variety: bpy.props.FloatProperty(
        name="Variety",
        description="1 draws places as the model learned, 0 takes the likeliest, more draws unlikely ones more often",
        default=1.0, min=0.0, soft_max=2.0, step=10, precision=2, options={"SKIP_SAVE"},
    )  # fmt: skip


class SamplingChoices(VarietyChoice):
    """That, and among how many places is chosen."""

    candidates: bpy.props.IntProperty(
        name="Candidates",
        description="Places that are drawn for each thing, of which those to be tried are chosen: more takes longer. "
        "0: as many as is usual for the model",
        default=0, min=0, soft_max=512, options={"SKIP_SAVE"},
    )  # fmt: skip

    def sampling(self) -> Sampling:
        """How places are drawn."""
        from ...unisg_blender.generate import Sampling

        return Sampling(self.variety, self.candidates)

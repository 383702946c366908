"""Where the shape of a new object comes from: the scene's own, else the assets beside the model, else a plain box."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...dataset.assets.asset import Asset, object_graph
from ...scene import SceneGraph
from ..observe.placeable import Placeable, box_placeable
from ..propose.trained_model import TrainedModel


class Library:
    """Assets of a model, opened as they are needed and kept."""

    def __init__(self, model: TrainedModel) -> None:
        self.model = model
        self._known: dict[int, Placeable] = {}
        self._own: dict[tuple[int, str], list[Placeable]] = {}
        self._scene: SceneGraph | None = None

    def placeable(
        self,
        category: str,
        scene: SceneGraph,
        rng: np.random.Generator,
        fits: Callable[[Placeable], bool] | None = None,
    ) -> Placeable:
        """Something of a category, drawn at random among what there is; among what ``fits``, if anything does."""
        if fits is not None and (
            fitting := [placeable for placeable in self.placeables(category, scene) if fits(placeable)]
        ):
            return fitting[int(rng.integers(len(fitting)))]
        own, numbers = self.of_scene(category, scene), self._numbers(category)
        if own:
            return own[int(rng.integers(len(own)))]
        if not numbers:
            return box_placeable(category, np.array(self.model.contract.priors.sizes[category]))
        return self._kept(numbers[int(rng.integers(len(numbers)))])

    def placeables(self, category: str, scene: SceneGraph) -> list[Placeable]:
        """All that there is of a category, apart from plain boxes."""
        return self.of_scene(category, scene) or [self._kept(number) for number in self._numbers(category)]

    def _numbers(self, category: str) -> list[int]:
        return [] if self.model.assets is None else self.model.assets.numbers(category)

    def _kept(self, number: int) -> Placeable:
        if number not in self._known:
            assert self.model.assets is not None
            self._known[number] = Placeable(self.model.assets.asset(number))
        return self._known[number]

    def of_scene(self, category: str, scene: SceneGraph) -> list[Placeable]:
        """The different objects of a category that a scene has already."""
        if scene is not self._scene:
            self._scene, self._own = scene, {}
        key = (id(scene), category)
        if key not in self._own:
            found: dict[tuple[int, ...], Placeable] = {}
            if category in scene.vocabulary:
                for row in np.flatnonzero(scene.category == scene.vocabulary.index(category)):
                    placeable = Placeable(object_graph(scene, int(row)))
                    meshes = tuple(id(mesh) for mesh in placeable.asset.graph.meshes)
                    if meshes:
                        found.setdefault(meshes, placeable)
            self._own[key] = list(found.values())
        return self._own[key]

    def shells(self) -> list[Asset]:
        """The room shells beside the model."""
        file = self.model.assets
        return [] if file is None else [file.asset(number) for number in file.numbers("")]

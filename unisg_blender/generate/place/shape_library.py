"""Where the shape of a new object comes from: the scene's own, else the assets beside the model, else a plain box."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from functools import cached_property

import numpy as np

from ...dataset.assets.asset import Asset, object_graph
from ...scene import SceneGraph
from ..observe.facing import front_first
from ..observe.placeable import Placeable, box_placeable
from ..propose.trained_model import TrainedModel

LEAST_SHARE = 1 / 3
"""Of the usual two larger sizes of a category, from which on a thing of a scene is one of it and no part of one."""


class Library:
    """Assets of a model by category number, opened as they are needed and kept."""

    def __init__(self, model: TrainedModel) -> None:
        self.model = model
        self._given: dict[str, list[Placeable]] = {}
        self._known: dict[int, Placeable] = {}
        self._own: dict[int, list[Placeable]] = {}
        self._scene: SceneGraph | None = None

    def preferring(self, shapes: Mapping[str, Sequence[Asset]]) -> Library:
        """One that has given shapes by category, rather than those of scenes and of the model; this one for none."""
        if not shapes:
            return self
        other = copy(self)
        other._given = {name: [Placeable(front_first(asset)) for asset in given] for name, given in shapes.items()}
        other._own, other._scene = {}, None
        return other

    def placeable(
        self, category: int, scene: SceneGraph, rng: np.random.Generator,
        fits: Callable[[Placeable], bool] | None = None,
    ) -> Placeable:  # fmt: skip
        """Something of a category, drawn at random among what there is; among what ``fits``, if anything does."""
        if fits is not None and (fitting := [shape for shape in self.placeables(category, scene) if fits(shape)]):
            return fitting[int(rng.integers(len(fitting)))]
        own, numbers = self._of_scene(category, scene), self._numbers(category)
        if own:
            return own[int(rng.integers(len(own)))]
        if numbers:
            return self._kept(numbers[int(rng.integers(len(numbers)))])
        contract = self.model.contract
        name = contract.vocabulary[category]
        return box_placeable(name, np.array(contract.priors.sizes[name]))

    def placeables(self, category: int, scene: SceneGraph) -> list[Placeable]:
        """All that there is of a category, apart from plain boxes."""
        return self._of_scene(category, scene) or [self._kept(number) for number in self._numbers(category)]

    def of_model(self, category: str) -> list[Placeable]:
        """The shapes of a category that lie beside the model."""
        vocabulary = self.model.contract.vocabulary
        numbers = self._numbers(vocabulary.index(category)) if category in vocabulary else []
        return [self._kept(number) for number in numbers]

    def of_scene(self, category: str, scene: SceneGraph) -> list[Placeable]:
        """The different shapes of a category that a scene has."""
        vocabulary = self.model.contract.vocabulary
        return self._of_scene(vocabulary.index(category), scene) if category in vocabulary else []

    @cached_property
    def shells(self) -> list[Asset]:
        """The room shells beside the model, read once: every room that begins with nothing looks at all of them."""
        file = self.model.assets
        return [] if file is None else [file.asset(number) for number in file.numbers("")]

    def _numbers(self, category: int) -> list[int]:
        file = self.model.assets
        return [] if file is None else file.numbers(self.model.contract.vocabulary[category])

    def _kept(self, number: int) -> Placeable:
        if number not in self._known:
            assert self.model.assets is not None
            self._known[number] = Placeable(self.model.assets.asset(number))
        return self._known[number]

    def _of_scene(self, category: int, scene: SceneGraph) -> list[Placeable]:
        """What is given of a category, else the different objects of it that a scene has already."""
        if given := self._given.get(self.model.contract.vocabulary[category]):
            return given
        if scene is not self._scene:
            self._scene, self._own = scene, {}
        if category not in self._own:
            found: dict[tuple[int, ...], Placeable] = {}
            name = self.model.contract.vocabulary[category]
            number = scene.vocabulary.index(name) if name in scene.vocabulary else len(scene.vocabulary)
            for row in np.flatnonzero(scene.category == number):
                asset = object_graph(scene, int(row))
                meshes = tuple(id(mesh) for mesh in asset.graph.meshes)
                if meshes and meshes not in found:
                    found[meshes] = Placeable(front_first(asset))
            shapes = list(found.values())
            self._own[category] = self._whole(name, shapes) if self._numbers(category) else shapes
        return self._own[category]

    def _whole(self, name: str, shapes: list[Placeable]) -> list[Placeable]:
        """Those that are no mere parts: a "Chair Middle" is no chair, for it is a pole."""
        usual = np.sort(np.array(self.model.contract.priors.sizes.get(name, (0, 0, 0))))[1:]
        return [shape for shape in shapes if (np.sort(2 * shape.half)[1:] >= LEAST_SHARE * usual).all()]

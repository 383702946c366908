"""Measures the mesh component: reconstruction, categories, stability and speed, on models held out of training."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...meshes import MeshFeature, decode_oriented_cloud, reconstruct, sample_surface
from ...meshes.decode import decode_unit
from ...meshes.normalise import UnitPlacement, normalise, size_channels
from ...meshes.shape_feature import POINTS, default_encoder
from ...meshes.shape_files import ShapeFile, of_split
from ...meshes.similar import MeshLibrary, mesh_library, quarter_turn_features
from ...meshes.sphere import sphere_template
from ...metrics.point_clouds import chamfer_l2, diagonal, f_score
from ...predict.category_model import LabelModel
from ...predict.name_evidence import name_scores
from ...scene.mesh import Mesh, mesh_from_faces
from ..reports import Table

DENSE = 6_000
"""Points per surface that quality is measured with."""
SPARSE = 500
"""Points per surface in the search for the nearest training mesh."""
FACES = 5000
MOST = 20


@dataclass(frozen=True, eq=False)
class SurfaceErrors:
    """A model with dense points of its surface in the unit sphere."""

    model: ShapeFile
    seed: int = 0

    @cached_property
    def samples(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Points and normals, float32 (6000, 3), normalised."""
        found = sample_surface(self.model.mesh, DENSE, self.seed)
        return normalise(found.points)[0], found.normals

    @property
    def points(self) -> NDArray[np.float32]:
        """Points float32 (6000, 3)."""
        return self.samples[0]

    @cached_property
    def sparse(self) -> NDArray[np.float32]:
        """500 points."""
        return normalise(sample_surface(self.model.mesh, SPARSE, self.seed).points)[0]


def measure_reconstruction(
    training: Sequence[ShapeFile], sets: dict[str, list[ShapeFile]], progress: Callable[[str], None]
) -> Table:
    """Chamfer distance (x 1000, unit sphere) and F-score (%) at 1 % of the diagonal: medians over each set."""
    known = [SurfaceErrors(model) for model in training]
    library = mesh_library([model.name for model in training], [model.mesh for model in training])
    rows = []
    for name, models in sets.items():
        progress(f"reconstruction of {len(models)} meshes: {name}")
        scores: dict[str, list[tuple[float, float]]] = {}
        for model in models:
            for method, points in _attempts(SurfaceErrors(model), known, library).items():
                truth = SurfaceErrors(model).points
                scores.setdefault(method, []).append(
                    (1000 * chamfer_l2(truth, points), 100 * f_score(points, truth, 0.01 * diagonal(truth)))
                )
        for method, pairs in scores.items():
            chamfers, f_scores = np.array(pairs).T
            rows.append(
                {
                    "set": name, "meshes": len(models), "method": method,
                    "chamfer_median": round(float(np.median(chamfers)), 3),
                    "chamfer_mean": round(float(chamfers.mean()), 3),
                    "f_score_median": round(float(np.median(f_scores)), 1),
                }
            )  # fmt: skip
    return rows


def _attempts(
    truth: SurfaceErrors, known: Sequence[SurfaceErrors], library: MeshLibrary
) -> dict[str, NDArray[np.floating]]:
    """Points (6000, 3) of the surface by each method."""
    mesh = truth.model.mesh
    vector = default_encoder().encode([mesh])[0].vector
    others = [k for k, surface in enumerate(known) if surface.model is not truth.model]
    by_feature = library.nearest(mesh, 2, use_size=False)
    copied = next(match.place for match in by_feature if match.place in set(others))
    apart = [chamfer_l2(truth.sparse, known[k].sparse) for k in others]
    closed = reconstruct(*truth.samples, 96)
    through = decode_oriented_cloud([MeshFeature(vector, UnitPlacement(np.zeros(3), 1.0))], DENSE)
    return {
        "AtlasNet": _decoded_points(vector),
        "AtlasNet's cloud of 6,000 points, screened Poisson": sample_surface(
            reconstruct(through[0][0], through[1][0], 96), DENSE, 1
        ).points,
        "copy of the nearest training mesh, by feature": known[copied].points,
        "copy of the nearest training mesh, by chamfer distance": known[others[int(np.argmin(apart))]].points,
        "screened Poisson from 6,000 oriented points": sample_surface(closed, DENSE, 1).points,
        "the same surface, sampled again": SurfaceErrors(truth.model, 1).points,
    }


def _decoded_points(vector: NDArray[np.float32]) -> NDArray[np.floating]:
    return sample_surface(mesh_from_faces("decoded", *decode_unit(vector, FACES)), DENSE, 1).points


def measure_categories(training: Sequence[ShapeFile], held_out: Sequence[ShapeFile]) -> Table:
    """Top-1 and top-3 accuracy (%) of categories for held-out models."""
    labels = LabelModel.load()
    asked = [model for model in held_out if model.category in {other.category for other in training}]
    vectors = np.stack([quarter_turn_features(model.mesh, default_encoder()) for model in training])
    sizes = np.stack([size_channels(np.ptp(model.mesh.bounds, axis=0)[None])[0] for model in training])
    spread = float(np.linalg.norm(vectors[:, 0] - vectors[:, 0].mean(axis=0), axis=1).mean())
    orders: dict[str, list[list[str]]] = {}
    for model in asked:
        own = quarter_turn_features(model.mesh, default_encoder())[0]
        by_shape = np.linalg.norm(vectors - own, axis=2).min(axis=1) / spread
        by_size = np.linalg.norm(sizes - size_channels(np.ptp(model.mesh.bounds, axis=0)[None]), axis=1)
        for method, scores in _label_scores(model, own, labels).items():
            order = np.argsort(-scores, kind="stable") if scores.any() else np.zeros(0, np.int64)
            orders.setdefault(method, []).append([labels.vocabulary[k] for k in order])
        distances = {
            "nearest neighbour by feature": by_shape,
            "nearest neighbour by box size": by_size,
            "nearest neighbour by feature and box size": np.hypot(by_shape, 0.25 * by_size),
        }
        for method, distance in distances.items():
            ranked = [training[k].category for k in np.argsort(distance, kind="stable")]
            orders.setdefault(method, []).append(list(dict.fromkeys(ranked)))
    truth = [model.category for model in asked]
    return [{"method": method, "meshes": len(asked), **_accuracy(found, truth)} for method, found in orders.items()]


def _label_scores(model: ShapeFile, vector: NDArray[np.float32], labels: LabelModel) -> dict[str, NDArray[np.float64]]:
    shape = labels.shape_scores(vector[None], np.ptp(model.mesh.bounds, axis=0)[None])[0]
    name, plain_name = labels.name_scores((model.name,)), labels.name_weight * name_scores(model.name, labels.lexicon)
    return {
        "unisg label, without the table of words": shape + plain_name,
        "unisg label, name only, without the table of words": plain_name,
        "unisg label, shape and size only": shape,
        "unisg label": shape + name,
        "unisg label, name only": name,
    }


def _accuracy(orders: Sequence[Sequence[str]], truth: Sequence[str]) -> dict[str, float]:
    place = [order.index(own) if own in order else len(order) + 99 for order, own in zip(orders, truth, strict=True)]
    return {f"top_{k}": round(100 * float(np.mean([p < k for p in place])), 1) for k in (1, 3)}


def measure_stability(models: Sequence[ShapeFile]) -> Table:
    """How far the feature moves, in % of the mean distance between two models, and whether it still finds its model."""
    encoder = default_encoder()
    clouds = [normalise(sample_surface(model.mesh, POINTS, 0).points)[0] for model in models]
    base = encoder.encode_clouds(clouds)
    between = np.linalg.norm(base[:, None] - base[None], axis=2)
    unit = between[np.triu_indices(len(base), 1)].mean()
    rows = []
    for name, changed in _changes(models, clouds):
        moved = encoder.encode_clouds(changed)
        apart = np.linalg.norm(moved[:, None] - base[None], axis=2)
        own = np.diagonal(apart) / unit
        found = (apart.argmin(axis=1) == np.arange(len(base))).mean()
        rows.append(
            {"change": name, "moved_median": round(100 * float(np.median(own)), 1), "found": round(100 * found, 1)}
        )
    return rows


def _changes(
    models: Sequence[ShapeFile], clouds: Sequence[NDArray[np.float32]]
) -> list[tuple[str, list[NDArray[np.float32]]]]:
    generator = np.random.default_rng(0)
    again = [normalise(sample_surface(model.mesh, POINTS, 1).points)[0] for model in models]
    fewer = [normalise(sample_surface(model.mesh, POINTS // 2, 2).points)[0] for model in models]
    noisy = [normalise(points + generator.normal(0, 0.01, points.shape))[0] for points in clouds]
    changes = [("other samples", again), ("half as many samples", fewer), ("noise of 1 % of the radius", noisy)]
    for angle in (5, 15, 45, 90, 180):
        changes.append((f"turned by {angle} degrees about the vertical", [p @ _turn(angle, 2).T for p in clouds]))
    return [*changes, ("tipped over by 90 degrees", [p @ _turn(90, 0).T for p in clouds])]


def _turn(degrees: float, axis: int) -> NDArray[np.float32]:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    turn = np.eye(3, dtype=np.float32)
    first, second = (axis + 1) % 3, (axis + 2) % 3
    turn[first, first] = turn[second, second] = c
    turn[first, second], turn[second, first] = -s, s
    return turn


def measure_speed(repeats: int) -> Table:
    """Milliseconds of one processor core (median of repeats); the time others take of it does not count."""
    sphere = _ball(10_000)
    samples = sample_surface(sphere, 2500)
    encoder = default_encoder()
    points = normalise(sample_surface(sphere, POINTS).points)[0]
    vector = encoder.encode_clouds([points])[0]
    jobs: dict[str, tuple[Callable[[], object], int]] = {
        "2,500 samples of a mesh of 10,000 faces": (lambda: sample_surface(sphere, 2500), 1),
        "features of 16 clouds at once, each": (lambda: encoder.encode_clouds([points] * 16), 16),
        "feature of one cloud": (lambda: encoder.encode_clouds([points]), 1),
        "mesh of 5,000 faces from a feature": (lambda: decode_unit(vector, FACES), 1),
        "mesh from 2,500 oriented points, 64 cells": (lambda: reconstruct(samples.points, samples.normals, 64), 1),
        "the same, simplified to 5,000 faces": (
            lambda: reconstruct(samples.points, samples.normals, 64, faces=FACES),
            1,
        ),
    }
    return [
        {"job": name, "milliseconds": round(_median_ms(job, repeats) / share, 2)} for name, (job, share) in jobs.items()
    ]


def _ball(faces: int) -> Mesh:
    points, triangles = sphere_template(faces)
    return mesh_from_faces("ball", points, triangles)


def _median_ms(job: Callable[[], object], repeats: int) -> float:
    job()
    spent = []
    for _ in range(max(repeats, 5)):
        start = time.process_time()
        job()
        spent.append(time.process_time() - start)
    return 1000 * float(np.median(spent))


def split_sets(models: Sequence[ShapeFile], rooms: Sequence[ShapeFile]) -> dict[str, list[ShapeFile]]:
    """The sets that are reported, 20 meshes of each at most: trained on, and three kinds of held-out ones."""
    sets = {
        "trained on": of_split(models, "train"),
        "held-out models, trained categories": of_split(models, "test"),
        "held-out categories": of_split(models, "unseen"),
        "held-out meshes of procedural rooms": of_split(rooms, "test"),
    }
    return {name: found[:: -(-len(found) // MOST)] for name, found in sets.items() if found}

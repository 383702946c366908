"""Scenes as ``torch_geometric`` graphs: one, or a dataset of them. Needs torch; import it through the package."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import MissingPackageError
from ...scene import SceneGraph
from ..format.columns import Columns, Vocabulary
from ..format.encoding import MeshEncoder, Sample, encode_scenes, known_form
from ..format.gather import TABLES, gather
from ..format.reader import open_dataset
from ..format.splits import split_rows
from .edge_poses import EdgePoses, with_edge_poses
from .graph_arrays import GraphArrays, graph_arrays
from .vocabularies import RELATION_KINDS, NumberedNames, as_names

try:
    import torch
    from torch_geometric.data import Batch
    from torch_geometric.data import Dataset as GraphDataset

    from .scene_data import Numbering, SceneData
except ImportError:
    raise MissingPackageError("torch-geometric", "learn") from None


def to_heterodata(
    graph: SceneGraph,
    form: str = "quaternion",
    vocabulary: Mapping[str, Sequence[str]] | None = None,
    mesh_encoder: MeshEncoder | None = None,
    edges: EdgePoses | None = None,
) -> SceneData:
    """A scenegraph as a heterogeneous graph that carries its vocabulary; docs/dataset.md lists its nodes and edges.

    Parameters
    ----------
    graph
        The scene.
    form
        Name in ``FORMS`` of the pose features in ``trs.x``.
    vocabulary
        NumberedNames by number, as ``open_dataset(path).vocabulary`` or ``common_vocabulary(graphs)``:
        categories that it lacks become -1, relations that it lacks are left out. When
        omitted, the scene's own categories, and the known kinds of relations before its own.
    mesh_encoder
        Gives ``mesh.feature``.
    edges
        Which relative poses edges between entities have as ``edge_attr``; none when omitted.
    """
    own = {"categories": graph.vocabulary, "relations": RELATION_KINDS}
    names = Vocabulary(own if vocabulary is None else vocabulary)
    known = {kind: len(found) for kind, found in names.names.items()}
    columns = encode_scenes([Sample(graph)], known_form(form), names, mesh_encoder)
    if vocabulary is not None:
        columns = _without_unknown(columns, known)
        names = Vocabulary(vocabulary)
    arrays = graph_arrays(columns, names.names["relations"])
    return _graph(arrays if edges is None else with_edge_poses(arrays, columns, form, edges), as_names(names.names))


def _without_unknown(columns: Columns, known: Mapping[str, int]) -> Columns:
    category = columns["entity.category"]
    kept = columns["relation.kind"] < known["relations"]
    rows = {key: columns[key][kept] for key in ("relation.subject", "relation.target", "relation.kind")}
    rows["relation.ptr"] = np.array([0, kept.sum()])
    return columns | rows | {"entity.category": np.where(category < known["categories"], category, -1)}


def _graph(arrays: GraphArrays, names: NumberedNames, data: Any = None) -> SceneData:
    """Fill a graph (or a batch) with the arrays."""
    data = SceneData() if data is None else data
    data.numbering = Numbering({names: 0})
    for kind, attributes in arrays.nodes.items():
        store = data[kind]
        for name, values in attributes.items():
            store[name] = _tensor(values)
    for edge, pairs in arrays.edges.items():
        data[edge].edge_index = _tensor(pairs)
    for edge, poses in arrays.edge_poses.items():
        data[edge].edge_attr = _tensor(poses)
    data.y = _tensor(arrays.label)
    return data


def _tensor(values: NDArray) -> torch.Tensor:
    return torch.from_numpy(values if values.flags.writeable else values.copy())


def _batch(arrays: GraphArrays, names: NumberedNames) -> Any:
    """The graph as a ``Batch``: what ``Batch.from_data_list`` makes of the single scenes, without making them."""
    data = _graph(arrays, names, Batch(_base_cls=SceneData))
    count = len(arrays.label)
    none = torch.zeros(count, dtype=torch.int64)
    data.numbering = {names: none}
    slices: dict[Any, Any] = {"y": torch.arange(count + 1), "numbering": {names: torch.arange(count + 1)}}
    increments: dict[Any, Any] = {"y": none, "numbering": {names: none}}
    ptr = {kind: torch.from_numpy(np.ascontiguousarray(starts)) for kind, starts in arrays.node_ptr.items()}
    for kind, attributes in arrays.nodes.items():
        data[kind].ptr = ptr[kind]
        data[kind].batch = torch.from_numpy(np.repeat(np.arange(count), np.diff(arrays.node_ptr[kind])))
        slices[kind] = dict.fromkeys(attributes, ptr[kind])
        increments[kind] = dict.fromkeys(attributes, none)
    for edge, starts in arrays.edge_ptr.items():
        slices[edge] = {"edge_index": torch.from_numpy(np.ascontiguousarray(starts))}
        shift = torch.stack([ptr[edge[0]][:-1], ptr[edge[2]][:-1]], dim=1)
        increments[edge] = {"edge_index": shift.unsqueeze(-1)}
        if edge in arrays.edge_poses:
            slices[edge]["edge_attr"], increments[edge]["edge_attr"] = slices[edge]["edge_index"], none
    data._num_graphs = count
    data._slice_dict = slices
    data._inc_dict = increments
    return data


class UniSGDataset(GraphDataset):
    """A dataset on disk as graphs; shards are mapped when they are first used, so memory stays constant.

    Works with PyG's ``DataLoader`` and its workers; :meth:`loader` is several times
    as fast, because it builds each batch straight from the columns.

    Parameters
    ----------
    path
        Folder of the dataset.
    transform
        Called on each graph: ``torch_geometric.transforms``, for instance
        ``ToUndirected(merge=False)`` for reverse edges. In :meth:`batch` it is
        called once, on the whole batch.
    verify
        Compare the checksum of each shard when it is first used.
    vocabulary
        NumberedNames to number as another dataset does (``UniSGDataset("train").vocabulary``); refused, as by
        :func:`..format.reader.open_dataset`, where this dataset has others.
    edges
        Which relative poses edges between entities have as ``edge_attr``; none when omitted.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        transform: Callable[[Any], Any] | None = None,
        verify: bool = True,
        vocabulary: Mapping[str, Sequence[str]] | None = None,
        edges: EdgePoses | None = None,
    ) -> None:
        self.edges = edges
        self.columns = open_dataset(path, verify, vocabulary=vocabulary)
        super().__init__(None, transform)

    @property
    def vocabulary(self) -> dict[str, tuple[str, ...]]:
        """The names that numbers stand for: "categories", "relations", "scenes"."""
        return self.columns.vocabulary

    @cached_property
    def _names(self) -> NumberedNames:
        return as_names(self.vocabulary)

    @property
    def form(self) -> str:
        """Name of the form of ``trs.x``."""
        return self.columns.form

    def len(self) -> int:
        """Number of scenes on disk."""
        return len(self.columns)

    def get(self, idx: int) -> SceneData:
        """The graph of one scene."""
        return _graph(self._arrays([idx]), self._names)

    def batch(self, indices: Sequence[int] | NDArray[np.integer]) -> Any:
        """Some scenes (numbers within this subset) as one ``Batch``."""
        numbers = np.asarray(indices, np.int64)
        if self._indices is not None:
            numbers = self._own_numbers[numbers]
        data = _batch(self._arrays(numbers), self._names)
        return data if self.transform is None else self.transform(data)

    @cached_property
    def _own_numbers(self) -> NDArray[np.int64]:
        """The scenes of this subset."""
        return np.asarray(self.indices(), np.int64)

    def index_select(self, idx: Any) -> UniSGDataset:
        """A subset; see PyG's ``Dataset.index_select``."""
        subset = super().index_select(idx)
        subset.__dict__.pop("_own_numbers", None)
        return subset

    def _arrays(self, numbers: Sequence[int] | NDArray[np.integer]) -> GraphArrays:
        if self.edges is None:
            return graph_arrays(gather(self.columns, numbers), self.vocabulary["relations"])
        columns = gather(self.columns, numbers, (*TABLES, "world"))
        return with_edge_poses(graph_arrays(columns, self.vocabulary["relations"]), columns, self.form, self.edges)

    def split(self, fractions: Sequence[float], seed: int, by_source: bool = False) -> list[UniSGDataset]:
        """Subsets for training, validation ..., at random by ``seed``; see :func:`..format.splits.split_rows`.

        With ``by_source`` scenes of one file stay together.
        """
        sources = np.asarray(self.columns.sources())[self._own_numbers].tolist() if by_source else None
        return [self.index_select(rows.tolist()) for rows in split_rows(len(self), fractions, seed, sources)]

    def loader(self, batch_size: int, shuffle: bool = False, workers: int = 0, seed: int = 0) -> Any:
        """A ``torch.utils.data.DataLoader`` of batches; ``shuffle`` draws another order each time, by ``seed``."""
        from torch.utils.data import BatchSampler, DataLoader, RandomSampler, SequentialSampler

        generator = torch.Generator().manual_seed(seed)
        order = RandomSampler(self, generator=generator) if shuffle else SequentialSampler(self)
        batches = BatchSampler(order, batch_size, drop_last=False)
        return DataLoader(
            _Batches(self), sampler=batches, batch_size=None, num_workers=workers, persistent_workers=workers > 0
        )


class _Batches(torch.utils.data.Dataset):
    """The view of a dataset that a loader asks for whole batches."""

    def __init__(self, dataset: UniSGDataset) -> None:
        self.dataset = dataset

    def __getitem__(self, indices: list[int]) -> Any:
        return self.dataset.batch(indices)

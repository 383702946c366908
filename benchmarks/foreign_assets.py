"""Assets of others with what was said of them once, looking at pictures: what each is, and which side is its front.

``foreign_assets.csv`` lists them. ``half`` is "unseen" for a third of the families, on which nothing was fitted. Where
an asset has no front, or two sides would do, ``fronts`` says so.
"""

from __future__ import annotations

import contextlib
import csv
from dataclasses import dataclass
from pathlib import Path

from unisg_blender.errors import UniSGError
from unisg_blender.formats.mesh_parts import whole_mesh
from unisg_blender.geometry.surface_contact import Triangles
from unisg_blender.meshes.mesh_files import mesh_paths
from unisg_blender.meshes.shape_files import ShapeFile, read_models
from unisg_blender.scene import Mesh

LIST = Path(__file__).with_name("foreign_assets.csv")
LEARNED = ("kaykit", "sweethome3d")
"""Makers whose splits ``pretrained/atlasnet_models.csv`` tells; of the others nothing was learned."""
COLLADA = "aws"


@dataclass(frozen=True, eq=False)
class ForeignAsset:
    """An asset: its mesh in metres, z up, what it is ("" for nothing that the models know), and its fronts."""

    name: str
    maker: str
    mesh: Mesh
    thing: str
    fronts: tuple[str, ...]
    unseen: bool
    split: str

    @property
    def triangles(self) -> Triangles:
        """(M, 3, 3) metres."""
        return self.mesh.points.astype(float)[self.mesh.triangles]


def read_assets(meshes: list[Path], others: list[Path]) -> list[ForeignAsset]:
    """The assets of the list that are there: in folders of ``meshes``; the ``others`` hold Collada files."""
    by_file = {name: model for folder in meshes for name, model in _by_file(folder).items()}
    found = []
    with LIST.open(newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            model = by_file.get(row["file"])
            mesh = model.mesh if model else _collada(row["file"], others)
            if mesh is not None:
                maker = row["file"].split("/")[0] if "/" in row["file"] else COLLADA
                split = model.split if model and maker in LEARNED else ""
                fronts = tuple(row["fronts"].split())
                unseen = row["half"] == "unseen"
                found.append(ForeignAsset(row["name"], maker, mesh, row["thing"], fronts, unseen, split))
    return found


def _by_file(folder: Path) -> dict[str, ShapeFile]:
    names = [path.relative_to(folder).as_posix() for path in mesh_paths(folder)]
    return dict(zip(names, read_models([folder]), strict=True))


def _collada(stem: str, folders: list[Path]) -> Mesh | None:
    """A mesh, in its file's own frame, of the first Collada file of a name that can be read."""
    for path in (path for folder in folders for path in sorted(folder.rglob("*.[dD][aA][eE]")) if path.stem == stem):
        with contextlib.suppress(UniSGError):  # some are cut off
            return whole_mesh(path, upright=False)
    return None

"""Where the meshes of a layout lie: in the folder that the user names, or around the layout's file."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from ..errors import UniSGError
from ..scene import Mesh
from .mesh_parts import KINDS, whole_mesh

MOST_FILES = 2_000_000
PACKAGE_MARKS = ("model.config", "package.xml")
PREFERRED = (".glb", ".gltf", ".obj", ".dae", ".stl", ".ply", ".off")
"""Where an asset lies there in several kinds, the first of these counts."""


@dataclass(eq=False)
class AssetFolder:
    """``named`` is the folder that the user gives, if any; ``around`` are folders near the file, looked into by name;
    ``used`` collects the files that were asked for and are there."""

    named: Path | None
    around: tuple[Path, ...] = ()
    used: set[Path] = field(default_factory=set)

    def __post_init__(self) -> None:
        if self.named is not None and not self.named.is_dir():
            raise UniSGError(f"there is no folder {self.named} with meshes")

    @property
    def roots(self) -> tuple[Path, ...]:
        """All folders, the named one first."""
        return (*((self.named,) if self.named else ()), *self.around)

    def at(self, relative: str) -> Path | None:
        """The file or folder of that path below one of the folders, if it is there; a path that leads out is none."""
        plain = os.path.normpath(relative.replace("\\", "/")) if relative else ""
        if not plain or os.path.isabs(plain) or plain.split(os.sep)[0] == os.pardir or "\0" in plain:
            return None
        for root in self.roots:
            place = root / plain
            if place.exists():
                if place.is_file():
                    self.used.add(place)
                return place
        return None

    def mesh_file(self, names: Iterable[str]) -> Path | None:
        """The file of an asset by the first of its names, with or without a path, that is known."""
        for name in filter(None, names):
            for ending in ("", *PREFERRED):
                place = self.at(name + ending)
                if place is not None and place.is_file() and place.suffix.lower() in KINDS:
                    return place
            found = self._index.get(name.replace("\\", "/").rpartition("/")[2].lower())
            if found is not None:
                self.used.add(found)
                return found
        return None

    def mesh(self, *names: str) -> Mesh | None:
        """The mesh of an asset in our frame, z up; None where it is not there."""
        found = self.mesh_file(names)
        return None if found is None else whole_mesh(found)

    def package(self, name: str) -> Path | None:
        """The folder of that name, below the named folder, that holds a model of Gazebo or a package of ROS."""
        return self._packages.get(name)

    @cached_property
    def _packages(self) -> dict[str, Path]:
        found: dict[str, Path] = {}
        for root, folders, names in os.walk(self.named) if self.named else ():
            folders[:] = sorted(name for name in folders if not name.startswith("."))
            if any(mark in names for mark in PACKAGE_MARKS):
                found.setdefault(Path(root).name, Path(root))
        return found

    @cached_property
    def _index(self) -> dict[str, Path]:
        """Mesh files below the named folder, by their names and by the names of the folders that hold only them."""
        found: dict[str, Path] = {}
        count = 0
        for root, folders, names in os.walk(self.named) if self.named else ():
            folders[:] = sorted(name for name in folders if not name.startswith("."))
            meshes = [name for ending in PREFERRED for name in sorted(names) if name.lower().endswith(ending)]
            for name in meshes:
                found.setdefault(Path(name).stem.lower(), Path(root, name))
            if meshes:
                found.setdefault(Path(root).name.lower(), Path(root, meshes[0]))
            if (count := count + len(names)) > MOST_FILES:
                raise UniSGError(f"{self.named} holds more than {MOST_FILES:,} files: name a folder further below")
        return found

"""The models that come with the software; ``docs/models`` has their cards."""

from __future__ import annotations

from pathlib import Path

from ..errors import UniSGError, did_you_mean

__all__ = ["default_generator", "find_generator", "shipped_generators"]

FOLDER = Path(__file__).resolve().parent


def default_generator() -> Path:
    """The generator for operating rooms."""
    return FOLDER / "operating_room.onnx"


def shipped_generators() -> list[Path]:
    """The generators that came with the software, those with assets beside them; the default one first."""
    found = [path for path in FOLDER.glob("*.onnx") if path.with_suffix(".assets.safetensors").is_file()]
    return sorted(found, key=lambda path: (path != default_generator(), path.name))


def find_generator(model: str | Path | None) -> Path:
    """A generator's file: the default one for None, a shipped one by its name ("living_room"), else the path itself.

    Raises
    ------
    UniSGError
        If it can only be a name (no such file, no ending), and no shipped one has it.
    """
    if model is None or str(model) == "":
        return default_generator()
    path = Path(model)
    named = {shipped.stem: shipped for shipped in shipped_generators()}
    name = str(model).replace("-", "_")
    if not path.exists() and not path.suffix and name not in named:
        hint = did_you_mean(name, named)
        raise UniSGError(f"there is no model {str(model)!r}{hint}: give a file, or one of {', '.join(named)}")
    return path if path.is_file() else named.get(name, path)

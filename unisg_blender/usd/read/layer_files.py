"""The layers that a USD file is composed of, each looked at before USD reads it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from pxr import Sdf, Tf, UsdUtils

from ...errors import UniSGError
from .nesting import check_nesting

PACKAGE = ".usdz["
PLACES = re.compile(
    r"(?:\(?\w*\)? ?Error in '\S+' at line \d+ in file \S+ : )|(?: \((?:instantiating|recomposing)\b.*)|(?: <0x\w+>)"
)
"""Where something happened in USD's own source, and in memory."""
RULE = re.compile(r"^.*?:(\d+):(\d+): parse error matching .+?(?= at ')")
"""Where text is not as it should be, with the rule of USD's grammar that it breaks."""
QUOTED = re.compile(r"(?<= at ')(.{40}).*")


def open_layers(path: Path) -> dict[str, Any]:
    """The layers of a file and all that they refer to, by absolute path; None for what USD cannot read.

    Raises
    ------
    UniSGError
        If one is a pipe or the like, or nests too deeply.
    """
    layers: dict[str, Any] = {}
    seen: set[tuple[str, str]] = set()
    waiting: list[tuple[str, dict[str, Any]]] = [(str(path.absolute()), {})]
    while waiting:
        name, variables = waiting.pop()
        key = (name, repr(sorted(variables.items())))
        if key in seen:
            continue
        seen.add(key)
        if name not in layers:
            _check_file(Path(name.partition(PACKAGE)[0] + ".usdz" if PACKAGE in name else name))
            layers[name] = _open(name)
        layer = layers[name]
        if layer is None:
            continue
        variables = dict(getattr(layer, "expressionVariables", {})) | variables
        for asset in filter(None, _dependencies(layer)):
            waiting.append((layer.ComputeAbsolutePath(_evaluated(asset, variables)), variables))
    return layers


def layer_files(path: Path) -> list[Path]:
    """All files that a USD file refers to, through other layers, too; what lies inside a package is part of it."""
    return [Path(name) for name in open_layers(path) if "[" not in name and Path(name) != path.absolute()]


@contextmanager
def quiet() -> Iterator[list[str]]:
    """Collect USD's diagnostics in a list instead of printing them."""
    messages: list[str] = []
    delegate = UsdUtils.CoalescingDiagnosticDelegate()
    try:
        yield messages
    finally:
        messages += [_said(item) for item in delegate.TakeUncoalescedDiagnostics()]
        del delegate


def _said(diagnostic: Any) -> str:
    try:
        return plain(diagnostic.commentary)
    except UnicodeDecodeError:  # USD quotes bytes of the damaged file
        return "it holds bytes that are no text"


def _check_file(file: Path) -> None:
    if file.exists() and not file.is_file() and not file.is_dir():
        raise UniSGError(f"{file}: is no file: a scene cannot be read from a pipe or a device")
    if file.is_file():
        check_nesting(file)


def _open(name: str) -> Any:
    """The layer of that name as it is on disk now; None if USD cannot read it, which composing tells."""
    try:
        with quiet():
            known = Sdf.Layer.Find(name)
            if known is not None:
                known.Reload()
            return known or Sdf.Layer.FindOrOpen(name)
    except Tf.ErrorException:
        return None


def _dependencies(layer: Any) -> list[str]:
    """What a layer refers to; nothing where that is damaged, which composing tells."""
    try:
        return layer.GetCompositionAssetDependencies()
    except Tf.ErrorException:
        return []


def _evaluated(asset: str, variables: Mapping[str, Any]) -> str:
    """An asset path, also where it is an expression of variables."""
    if not asset.startswith("`"):
        return asset
    try:
        return str(Sdf.VariableExpression(asset).Evaluate(dict(variables)).value or "")
    except Tf.ErrorException:
        return ""


def plain(message: str) -> str:
    """What USD says, in one line without places in its own source and in memory."""
    line = RULE.sub(r"line \1, column \2 is no USD", " ".join(message.split()))
    return PLACES.sub("", QUOTED.sub(r"\1 ...", line)).strip(" '")[:300]

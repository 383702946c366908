"""The two forms of a glTF file, ``.glb`` and ``.gltf``: a JSON document and its bytes.

Source: glTF 2.0 specification, sections 3.6.1 (buffers, data URIs) and 4 (GLB).
"""

from __future__ import annotations

import base64
import json
import struct
from typing import Any

from ...errors import UniSGError
from ...runtime.json_records import parse_json

MAGIC = b"glTF"
JSON_CHUNK, BIN_CHUNK = 0x4E4F534A, 0x004E4942
DATA_URI = "data:application/octet-stream;base64,"


def packed(document: dict[str, Any], data: bytes, binary: bool) -> bytes:
    """A file of a document, whose one buffer is ``data``: a ``.glb``, or a ``.gltf`` with the bytes in it."""
    buffer: dict[str, Any] = {"byteLength": len(data)}
    if not binary:
        buffer["uri"] = DATA_URI + base64.b64encode(data).decode("ascii")
    text = _text(document | ({"buffers": [buffer]} if data else {}))
    if not binary:
        return text
    chunks = [(JSON_CHUNK, text + b" " * (-len(text) % 4))]
    if data:
        chunks.append((BIN_CHUNK, data + b"\0" * (-len(data) % 4)))
    body = b"".join(struct.pack("<II", len(chunk), kind) + chunk for kind, chunk in chunks)
    if len(body) + 12 >= 2**32:
        raise UniSGError("the scene has more than the 4 GB that a .glb can hold: leave out what is not needed")
    return MAGIC + struct.pack("<II", 2, len(body) + 12) + body


def unpacked(content: bytes, what: str) -> tuple[Any, bytes]:
    """The document of a file and the bytes that it has in itself, b"" for none.

    Raises
    ------
    UniSGError
        If it is no glTF file; ``what`` is what the message calls it.
    """
    if content[:4] != MAGIC:
        document = parse_json(content, what)
        return document, _own_bytes(document)
    document, data, place = None, b"", 12
    while place + 8 <= len(content):
        size, kind = struct.unpack_from("<II", content, place)
        chunk = content[place + 8 : place + 8 + size]
        if kind == JSON_CHUNK and document is None:
            document = parse_json(chunk, what)
        elif kind == BIN_CHUNK and not data:
            data = chunk
        place += 8 + size
    return document, data


def _own_bytes(document: Any) -> bytes:
    try:
        uri = document["buffers"][0]["uri"]
        return base64.b64decode(uri.removeprefix(DATA_URI), validate=True) if uri.startswith(DATA_URI) else b""
    except (LookupError, TypeError, AttributeError, ValueError):
        return b""


def _text(document: dict[str, Any]) -> bytes:
    text = json.dumps(document, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return text.encode("utf-8", "replace")  # a lone surrogate in a name has no UTF-8

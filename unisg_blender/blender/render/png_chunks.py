"""PNG files without words: Blender writes into each how long it took, which makes each another one."""

from __future__ import annotations

import struct
from pathlib import Path

START = 8
WORDS = (b"tEXt", b"zTXt", b"iTXt", b"tIME")


def remove_words(path: Path) -> None:
    """Take the texts and times out of a PNG file; its pixels stay."""
    data = path.read_bytes()
    kept, place = [data[:START]], START
    while place < len(data):
        (size,) = struct.unpack_from(">I", data, place)
        end = place + 12 + size
        if data[place + 4 : place + 8] not in WORDS:
            kept.append(data[place:end])
        place = end
    path.write_bytes(b"".join(kept))

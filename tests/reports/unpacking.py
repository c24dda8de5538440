"""What is in a page, read as its JavaScript reads it."""

from __future__ import annotations

import base64
import json
import re
import zlib
from typing import Any

import numpy as np

TYPES = {
    "Float32Array": "<f4",
    "Float64Array": "<f8",
    "Uint8Array": "u1",
    "Uint16Array": "<u2",
    "Int16Array": "<i2",
    "Int32Array": "<i4",
    "Uint32Array": "<u4",
}


def unpacked(text: str) -> Any:
    """Content that `packed` took."""
    data = zlib.decompress(base64.b64decode(text))
    size = int.from_bytes(data[:4], "little")
    start = 8 + -(-size // 8) * 8

    def array(found: dict[str, Any]) -> Any:
        if set(found) != {"$array"}:
            return found
        kind, at, length = found["$array"]
        assert (start + at) % 8 == 0
        return np.frombuffer(data, TYPES[kind], length, start + at)

    return json.loads(data[8 : 8 + size], object_hook=array)


def data_of(page: str) -> Any:
    """Data of a page; None where it has none."""
    found = re.search(r'<script type="text/plain" id="data">([^<]*)</script>', page)
    return None if found is None else unpacked(found[1])


def dequantised(stored: dict[str, Any]) -> Any:
    """Values of `quantised`."""
    return stored["low"] + (stored["high"] - stored["low"]) / 65535.0 * stored["codes"]

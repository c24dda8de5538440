"""Data for a page: JSON with arrays, compressed, as text that HTML need not escape."""

import base64
import json
import math
import zlib
from hashlib import sha256
from typing import Any

import numpy as np
from numpy.typing import NDArray

TYPES = {"<f4": "Float32Array", "<f8": "Float64Array", "<u1": "Uint8Array", "|u1": "Uint8Array"} | {
    "<u2": "Uint16Array",
    "<i2": "Int16Array",
    "<i4": "Int32Array",
    "<u4": "Uint32Array",
}
"""JavaScript's names of the types of arrays that may be packed."""

ALIGNED = 8
"""Arrays begin at multiples of this many bytes."""

STEPS = {np.dtype(np.uint16): 65535, np.dtype(np.int16): 32767}


def compressed(data: bytes) -> str:
    """Bytes by zlib (RFC 1950) and base64."""
    return base64.b64encode(zlib.compress(data, 9)).decode("ascii")


def packed(content: Any) -> str:
    """Pack dicts, lists, text, numbers and arrays; what is equal among the arrays is there once.

    Parameters
    ----------
    content : dict, list, str, number, None, bytes or array
        Numbers that are not finite become None, outside of arrays. Bytes become an array.

    Returns
    -------
    str
        Letters, digits, ``+``, ``/`` and ``=``. Unpacked, it is the length of a JSON text in 4 bytes, 4 bytes of
        nothing, this text, and arrays behind it, all at multiples of 8 bytes and with the lowest byte first. In the
        JSON, ``{"$array": [type, start, length]}`` stands for an array, which starts so many bytes behind the text.

    Raises
    ------
    TypeError
        Something else is in it.
    """
    store = _Store()
    text = json.dumps(store.plain(content), allow_nan=False, separators=(",", ":")).encode()
    head = len(text).to_bytes(4, "little") + bytes(4)
    return compressed(head + _padded(text) + b"".join(store.parts))


def packed_size(content: Any) -> int:
    """Letters that packed content takes [bytes]."""
    return len(packed(content))


def quantised(values: NDArray[Any], low: float, high: float) -> dict[str, Any]:
    """Values between two limits in 16 bits each; those beyond are taken for the limits.

    Returns
    -------
    dict
        ``low``, ``high``, and ``codes``, an array of the same shape, flat: 0 is ``low``, 65535 is ``high``.
    """
    if not high > low:
        low, high = float(low), float(low) + 1.0
    share = (np.nan_to_num(values.astype(np.float64), nan=low) - low) / (high - low)
    codes = np.round(np.clip(share, 0.0, 1.0) * STEPS[np.dtype(np.uint16)]).astype(np.uint16)
    return {"low": float(low), "high": float(high), "codes": codes.ravel()}


class _Store:
    """Takes the arrays out of content, and tells where each is."""

    def __init__(self) -> None:
        self.parts: list[bytes] = []
        self._size = 0
        self._known: dict[bytes, list[Any]] = {}

    def plain(self, content: Any) -> Any:
        if isinstance(content, dict):
            return {str(key): self.plain(value) for key, value in content.items()}
        if isinstance(content, list | tuple):
            return [self.plain(value) for value in content]
        if isinstance(content, bytes):
            content = np.frombuffer(content, np.uint8)
        if isinstance(content, np.ndarray):
            return {"$array": self._place(content)}
        if isinstance(content, np.generic):
            content = content.item()
        if isinstance(content, float) and not math.isfinite(content):
            return None
        if content is None or isinstance(content, str | bool | int | float):
            return content
        raise TypeError(f"{type(content).__name__} cannot be packed")

    def _place(self, values: NDArray[Any]) -> list[Any]:
        values = np.ascontiguousarray(values).ravel()
        values = values.astype(values.dtype.newbyteorder("<"), copy=False)
        kind = TYPES.get(values.dtype.str)
        if kind is None:
            raise TypeError(f"an array of {values.dtype} cannot be packed")
        data = values.tobytes()
        key = kind.encode() + sha256(data).digest()
        if key not in self._known:
            self._known[key] = [kind, self._size, len(values)]
            self.parts.append(_padded(data))
            self._size += len(self.parts[-1])
        return self._known[key]


def _padded(data: bytes) -> bytes:
    return data + bytes(-len(data) % ALIGNED)
